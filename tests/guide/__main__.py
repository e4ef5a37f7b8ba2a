"""`python -m tests.guide`: write the made parts of the guide anew: tree, error codes, figures."""

from tests.guide.codes import PAGE as CODES_PAGE
from tests.guide.codes import codes
from tests.guide.figures import figures
from tests.guide.pages import with_part
from tests.guide.tree import PAGE as TREE_PAGE
from tests.guide.tree import tree

TREE_PAGE.write_text(with_part(TREE_PAGE, "tree", tree()))
CODES_PAGE.write_text(with_part(CODES_PAGE, "codes", codes()))
for name, (page, made) in figures().items():
    page.write_text(with_part(page, name, made))
