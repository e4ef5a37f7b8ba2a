"""The tree of the code in `how-the-code-is-laid-out.md`: a line for each module and folder.

The line of a module is the first sentence of its docstring; so is that of a package. Folders that
are not packages, and those of the tests, have their lines in `FOLDERS`.
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
    "service/client": "The client, a project of its own, and its old import name.",
    "service/deploy": "Files for Docker Compose, Kubernetes and KEDA.",
    "service/guide": "These pages.",
    "service/page": "The web page, plain JavaScript modules: `main.js` puts it together.",
    "service/page/chart": "The chart of the front, the slider, and the growth of the hypervolume.",
    "service/page/common": "The kinds of plans, numbers, colours, and the names of objectives.",
    "service/page/fleet": "Fleets: their request in the form, and the selected plan by vehicle.",
    "service/page/inputs": "The fields of a request, and cities clicked into place.",
    "service/page/map": "The maps: two planes, one of both objectives, or a grid.",
    "service/page/map/ways": "Ways along the streets: of an example, or of a routing engine.",
    "service/page/planning": "Calls of the service, and the refusals that it answers with.",
    "service/page/result": "The front that was found: figures, comparison, links and downloads.",
    "service/page/vendor": "Libraries of others, as they are released, each with its licence.",
    "service/reference": "The HTTP reference at `/docs`, and the examples in it.",
    "models/checkpoints": "The weights of the released networks, each with its model card.",
    "tests": "Tests, in folders like those of the modules.",
    "tests/benchmarks": "The figures of the project: `python -m tests.benchmarks NAME`.",
    "tests/fuzz": "Fuzzed bodies: `python -m tests.fuzz` for many of them.",
    "tests/guide": "Tests of these pages, and what makes their tree and tables.",
    "tests/helpers": "Live servers, stand-in actors, a browser and a Redis for the tests.",
    "tests/page": "The page, in a real browser.",
}
_SHOWN_AS_ONE = ("service/page/vendor", "service/reference", "tests/benchmarks", "tests/page")
_SUFFIXES = (".py", ".js", ".lua")
_SKIPPED = ("__init__.py", "__pycache__")


def tree() -> str:
    """Return the tree as Markdown."""
    tops = ("service", "models", "export", "tests")
    lines = [line for top in tops for line in _lines(ROOT / top, 0)]
    return "```text\n" + "\n".join(lines) + "\n```\n"


def modules() -> set[str]:
    """Return the modules of service, models and export that the tree must name, as paths."""
    found = {
        str(path.relative_to(ROOT))
        for top in ("service", "models", "export")
        for path in (ROOT / top).rglob("*")
        if path.suffix in _SUFFIXES and path.name not in _SKIPPED
    }
    return {path for path in found if not path.startswith(_SHOWN_AS_ONE)}


def named(block: str) -> set[str]:
    """Return the paths of files that a tree names."""
    folders: list[str] = []
    found = set()
    for indent, name in re.findall(r"^((?:  )*)(\S+)  ", block, re.MULTILINE):
        depth = len(indent) // 2
        del folders[depth:]
        if name.endswith("/"):
            folders.append(name)
        elif depth:
            found.add("".join(folders) + name)
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
    lines = _line(f"{folder.name}/", _about(folder), depth)
    if name in _SHOWN_AS_ONE:
        return lines
    entries = sorted(folder.iterdir(), key=lambda entry: (entry.is_dir(), entry.name))
    for entry in entries:
        if entry.is_dir() and _is_shown(entry):
            lines += _lines(entry, depth + 1)
        elif entry.suffix in _SUFFIXES and entry.name not in _SKIPPED and name[:5] != "tests":
            lines += _line(entry.name, sentence(entry), depth + 1)
    return lines


def _is_shown(folder: Path) -> bool:
    if str(folder.relative_to(ROOT)) in FOLDERS:
        return True
    if folder.name in _SKIPPED:
        return False
    return any(path.suffix in _SUFFIXES for path in folder.iterdir())


def _about(folder: Path) -> str:
    name = str(folder.relative_to(ROOT))
    if name in FOLDERS:
        return FOLDERS[name]
    package = folder / "__init__.py"
    about = sentence(package) if package.exists() else ""
    if not about and name.startswith("tests/"):
        of = name.removeprefix("tests/")
        about = f"Tests of `{of if of.startswith(('models', 'export')) else f'service/{of}'}`."
    return about


def _line(name: str, about: str, depth: int) -> list[str]:
    first = f"{'  ' * depth}{name}  ".ljust(32)
    return textwrap.wrap(
        about or "-",
        WIDTH,
        initial_indent=first,
        subsequent_indent=" " * 32,
        break_long_words=False,
        break_on_hyphens=False,
    )
