"""Rules of the repository that can be run."""

import ast
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from statistics import median

from tests.guide.tree import sentence

ROOT = Path(__file__).parent.parent
TOP_LEVEL = {"pyproject.toml", "Dockerfile", "README.md", "LICENSE"} | {
    "service",
    "models",
    "export",
    "tests",
}

MOST_AT_THE_TOP = 17  # Python files of service/ itself
MOST_IN_A_FOLDER = 30  # modules, beside the __init__.py
MOST_LINES = 400
MOST_IN_A_CHAIN = 25  # modules, each importing the next
CODE = ("service", "models", "export")
RIDDLES = re.compile(r"(What|Who|Whatever|Whichever|How|Where|When)\b")


def modules(*suffixes: str) -> list[Path]:
    """The modules of the code itself, without libraries of others."""
    paths = [Path(path) for path in tracked() if path.startswith(CODE)]
    return [path for path in paths if path.suffix in suffixes and "vendor" not in path.parts]


def tracked() -> list[str]:
    listed = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return listed.stdout.splitlines()


def test_the_service_starts_without_the_factory() -> None:
    code = (
        "import sys, service.api.app, service.actor, service.cli.commands;"
        "sys.exit(len({'torch', 'onnx', 'models', 'export'} & set(sys.modules)))"
    )
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True)


def test_the_top_level_holds_what_the_design_names_and_nothing_else() -> None:
    visible = {path.split("/")[0] for path in tracked() if not path.startswith(".")}
    assert visible == TOP_LEVEL


def test_the_service_has_few_files_at_its_top() -> None:
    top = [path for path in modules(".py") if path.parent == Path("service")]
    assert len(top) <= MOST_AT_THE_TOP


def test_no_folder_holds_too_many_modules() -> None:
    found = Counter(path.parent for path in modules(".py", ".js") if path.name != "__init__.py")
    assert {folder: n for folder, n in found.items() if n > MOST_IN_A_FOLDER} == {}


def test_no_module_is_too_long_and_most_are_neither_long_nor_short() -> None:
    paths = [path for path in modules(".py") if path.name not in ("__init__.py", "__main__.py")]
    lines = {path: len((ROOT / path).read_text().splitlines()) for path in paths}
    assert {path: n for path, n in lines.items() if n > MOST_LINES} == {}
    assert 80 <= median(lines.values()) <= 160


def test_every_module_says_what_it_is_for() -> None:
    said = {path: sentence(ROOT / path) for path in modules(".py", ".js")}
    assert [path for path, first in said.items() if not first] == []
    assert {path: first for path, first in said.items() if RIDDLES.match(first)} == {}


def test_the_readme_and_continuous_integration_run_the_same_test_command() -> None:
    [command] = [
        line.strip()
        for line in (ROOT / "README.md").read_text().splitlines()
        if ".venv/bin/pytest" in line and "pip install" in line
    ]
    assert command.replace("pip install", "pip install -q") in (ROOT / ".ci/run").read_text()


def test_every_released_actor_has_a_model_card_and_a_checkpoint() -> None:
    for actor in (ROOT / "service/actors").glob("*.onnx"):
        assert (ROOT / f"models/checkpoints/{actor.stem}.md").exists()
        assert (ROOT / f"models/checkpoints/{actor.stem}.pt").exists()


def opens_text(call: ast.Call) -> bool:
    """Whether a call reads or writes text in the encoding of the locale."""
    name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
    given = [each.value for each in call.args if isinstance(each, ast.Constant)]
    named = {each.arg: each.value for each in call.keywords}
    if "encoding" in named or None in named:
        return False
    if name in ("run", "Popen", "check_output"):
        return "text" in named or "universal_newlines" in named
    modes = [
        each for each in given if isinstance(each, str) and re.fullmatch("[rwaxtb+]{1,3}", each)
    ]
    if name == "open" and isinstance(call.func, ast.Attribute):  # of a path, if it has a mode
        return bool(modes or "newline" in named) and "b" not in "".join(modes)
    if name in ("open", "fdopen", "TextIOWrapper"):
        return "b" not in "".join(modes)
    return (name == "read_text" and not call.args) or (name == "write_text" and len(call.args) == 1)


def test_every_text_is_read_and_written_in_an_encoding_that_is_said() -> None:
    """Else that of the locale is taken, which is ASCII where it is POSIX."""
    commands = [Path(path) for path in tracked() if path.startswith("tests/benchmarks/")]
    found = [
        f"{path}:{node.lineno}"
        for path in [*modules(".py"), *(each for each in commands if each.suffix == ".py")]
        for node in ast.walk(ast.parse((ROOT / path).read_bytes()))
        if isinstance(node, ast.Call) and opens_text(node)
    ]
    assert found == []


def test_no_chain_of_imports_is_long() -> None:
    """What a module imports when it is loaded, and what that imports in turn."""
    names = {".".join(path.with_suffix("").parts): path for path in modules(".py")}
    names = {name.removesuffix(".__init__"): path for name, path in names.items()}

    def imported(name: str) -> Iterator[str]:
        for node in ast.parse((ROOT / names[name]).read_text()).body:
            if isinstance(node, ast.Import):
                yield from (alias.name for alias in node.names if alias.name in names)
            if isinstance(node, ast.ImportFrom) and node.module in names:
                for alias in node.names:
                    inside = f"{node.module}.{alias.name}"
                    yield inside if inside in names else node.module

    @cache
    def length(name: str) -> int:
        return 1 + max((length(each) for each in imported(name) if each != name), default=0)

    assert max(map(length, names)) <= MOST_IN_A_CHAIN
