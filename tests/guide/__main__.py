"""`python -m tests.guide`: write anew what is made of the code.

Those are parts of the guide (tree, error codes, figures), the types and the help of the client, and
the kinds and measures of plans for the page.
"""

from tests.guide.codes import PAGE as CODES_PAGE
from tests.guide.codes import codes, faults, remedies
from tests.guide.figures import figures
from tests.guide.members import JSON, json_file, type_files
from tests.guide.page_tables import page_tables
from tests.guide.pages import with_part
from tests.guide.tree import PAGE as TREE_PAGE
from tests.guide.tree import tree

TREE_PAGE.write_text(with_part(TREE_PAGE, "tree", tree()))
CODES_PAGE.write_text(with_part(CODES_PAGE, "codes", codes()))
CODES_PAGE.write_text(with_part(CODES_PAGE, "faults", faults()))
CODES_PAGE.write_text(with_part(CODES_PAGE, "remedies", remedies()))
JSON.write_text(json_file())
for path, module in {**type_files(), **page_tables()}.items():
    path.write_text(module)
for name, (page, made) in figures().items():
    page.write_text(with_part(page, name, made))
