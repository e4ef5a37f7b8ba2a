"""`python -m tests.guide`: write anew what is made of the code.

Those are parts of the guide (tree, error codes, figures) and the help of the client.
"""

from tests.guide.codes import PAGE as CODES_PAGE
from tests.guide.codes import codes
from tests.guide.figures import figures
from tests.guide.member_sentences import FILE as MEMBERS_FILE
from tests.guide.member_sentences import member_lines
from tests.guide.pages import with_part
from tests.guide.tree import PAGE as TREE_PAGE
from tests.guide.tree import tree

TREE_PAGE.write_text(with_part(TREE_PAGE, "tree", tree()))
CODES_PAGE.write_text(with_part(CODES_PAGE, "codes", codes()))
MEMBERS_FILE.write_text(member_lines())
for name, (page, made) in figures().items():
    page.write_text(with_part(page, name, made))
