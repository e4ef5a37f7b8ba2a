"""The client as a distribution of its own, in the full install, and under its old name."""

import subprocess
import sys
import tomllib
from pathlib import Path
from zipfile import ZipFile

import pytest
from hatchling.builders.wheel import WheelBuilder

ROOT = Path(__file__).parents[2]
CLIENT = ROOT / "service/client"
MODULES = {
    f"{path.relative_to(CLIENT)}"
    for path in (CLIENT / "paretour").rglob("*")
    if path.is_file() and path.suffix != ".pyc"
}
RECORD_IMPORTS = """
import builtins, sys
imported, real = set(), builtins.__import__
def record(name, *arguments):
    if arguments and arguments[0]["__name__"].partition(".")[0] == "paretour":
        imported.add(name.partition(".")[0])
    return real(name, *arguments)
builtins.__import__ = record
from paretour import *
print(*sorted(imported - sys.stdlib_module_names))
"""


def python(code: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", code]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)


def wheel_of(project: Path, directory: Path) -> list[str]:
    """The files in the wheel of a project, but for those about the wheel itself."""
    [wheel] = WheelBuilder(str(project)).build(directory=str(directory), versions=["standard"])
    with ZipFile(wheel) as archive:
        return [name for name in archive.namelist() if ".dist-info/" not in name]


def test_the_clients_own_wheel_holds_the_client_and_nothing_else(tmp_path: Path) -> None:
    files = wheel_of(CLIENT, tmp_path)
    assert "paretour/py.typed" in files
    assert sorted(files) == sorted(MODULES)


def test_the_full_wheel_holds_the_client_once(tmp_path: Path) -> None:
    files = wheel_of(ROOT, tmp_path)
    assert len(files) == len(set(files))
    assert {name.partition("/")[0] for name in files} == {"service", "models", "export", "paretour"}
    assert {name for name in files if name.startswith("paretour/")} == MODULES
    assert not [name for name in files if name.startswith("service/client")]


def test_the_client_imports_httpx_and_numpy_only() -> None:
    assert python(RECORD_IMPORTS).stdout.split() == ["httpx", "numpy", "paretour"]


def test_the_client_demands_what_it_imports() -> None:
    project = tomllib.loads((CLIENT / "pyproject.toml").read_text())["project"]
    assert {demand.partition(">")[0] for demand in project["dependencies"]} == {"httpx", "numpy"}


def test_the_readme_of_the_client_runs(url: str, capsys: pytest.CaptureFixture[str]) -> None:
    code = (CLIENT / "README.md").read_text().split("```python\n")[1].split("```")[0]
    exec(code.replace("http://localhost:8000", url), {})
    assert capsys.readouterr().out
