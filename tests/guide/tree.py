"""The tree of folders in `how-the-code-is-laid-out.md`: a line for each folder with modules.

The line of a package is the first sentence of its docstring. Folders that are not packages, and
those of the tests, have their lines in `FOLDERS`.
"""

import ast
import re
import textwrap
from pathlib import Path

from tests.guide.pages import GUIDE, ROOT

PAGE = GUIDE / "how-the-code-is-laid-out.md"
WIDTH = 118
FOLDERS = {
    "service/actors": "The released networks, an ONNX file each.",
    "service/client": "The client, a project of its own.",
    "service/deploy": "Files for Docker Compose, Kubernetes, KEDA, nginx, Prometheus and Grafana.",
    "service/guide": "The pages of this guide, in Markdown.",
    "service/guide/site": "The style sheet and the script of the guide in a browser.",
    "service/page": "The web page: plain JavaScript modules, which `main.js` puts together.",
    "service/page/chart": "The chart of the front and its labels; the slider; the growth of the"
    " hypervolume.",
    "service/page/common": "The kinds of plans, colours, the format of numbers, and the names of"
    " objectives.",
    "service/page/fleet": "Fleets and robots: their request in the form, and the selected plan by"
    " vehicle.",
    "service/page/inputs": "The form: its fields, the table of stops, and stops clicked on a map.",
    "service/page/map": "The maps of stops and tours: the earth, planes, or the grid of a robot's"
    " map.",
    "service/page/map/ways": "Tours drawn along the streets.",
    "service/page/opening": "Files, pasted text and examples, before they are in the form.",
    "service/page/planning": "Requests to the service, its progress and errors, and replanning.",
    "service/page/result": "The front that was found: figures, comparison, links, downloads, and"
    " pictures.",
    "service/page/today": "A fleet's day: what is done by now, what has changed, and the rest.",
    "service/page/vendor": "Libraries of others, as they are released, each with its licence.",
    "service/reference": "The HTTP reference at `/docs`, and the examples in it.",
    "models/checkpoints": "The weights of the released networks, each with its model card.",
    "tests": "Tests, in the same folders as the modules that they test. Beside them:",
    "tests/benchmarks": "The project's figures: `python -m tests.benchmarks NAME`.",
    "tests/fuzz": "Random and damaged bodies: `python -m tests.fuzz` for many of them.",
    "tests/guide": "Tests of the README and the guide; `python -m tests.guide` writes this tree.",
    "tests/helpers": "Live servers, stand-in actors, a browser and a Redis for the tests.",
    "tests/page": "Tests of the page, in a real browser and in Node.",
}
_SHOWN_AS_ONE = ("service/page/vendor", "service/reference")
_SUFFIXES = (".py", ".js", ".lua")


def tree() -> str:
    """Return the tree as Markdown."""
    tops = ("service", "models", "export", "tests")
    lines = [line for top in tops for line in _lines(ROOT / top, 0)]
    return "```text\n" + "\n".join(lines) + "\n```\n"


def named(block: str) -> set[str]:
    """Return the paths of the folders that a tree names."""
    parents: list[str] = []
    found = set()
    for indent, name in re.findall(r"^((?:  )*)(\S+)/  ", block, re.MULTILINE):
        parents[len(indent) // 2 :] = [name]
        found.add("/".join(parents))
    return found


def sentence(path: Path) -> str:
    """Return the first sentence of a module's docstring, or of a script's first comment."""
    text = path.read_text()
    if path.suffix == ".py":
        documented = ast.get_docstring(ast.parse(text)) or ""
    else:
        [documented] = re.findall(r"\A(?:/\*\*|--) ?(.*?)(?: \*/)?$", text, re.MULTILINE) or [""]
    paragraph = " ".join(documented.split("\n\n")[0].split())
    return re.split(r"(?<=[.?!])\s+(?=[A-Z`])", paragraph)[0]


def _lines(folder: Path, depth: int) -> list[str]:
    name = str(folder.relative_to(ROOT))
    lines = _line(f"{folder.name}/", FOLDERS.get(name) or sentence(folder / "__init__.py"), depth)
    if name not in _SHOWN_AS_ONE:
        for inner in sorted(folder.iterdir()):
            if inner.is_dir() and _is_shown(inner):
                lines += _lines(inner, depth + 1)
    return lines


def _is_shown(folder: Path) -> bool:
    name = str(folder.relative_to(ROOT))
    if name in FOLDERS:
        return True
    modules = (path for path in folder.iterdir() if path.suffix in _SUFFIXES)
    return not name.startswith("tests/") and any(modules)


def _line(name: str, about: str, depth: int) -> list[str]:
    return textwrap.wrap(
        about,
        WIDTH,
        initial_indent=f"{'  ' * depth}{name}  ".ljust(26),
        subsequent_indent=" " * 26,
        break_long_words=False,
        break_on_hyphens=False,
    )
