"""`python -m tests.benchmarks`: what it prints, what it measures, and which files it writes."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.benchmarks import __main__, concave, provenance
from tests.benchmarks.provenance import RESULTS, ROOT, Run, Unstored, load

STORED = [path.stem for path in RESULTS.glob("*.json")]


@pytest.fixture
def anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the tracked files, and the folder of what is measured and not stored."""
    tracked = tmp_path / "tracked"
    tracked.mkdir()
    (tracked / "concave.json").write_text(
        (RESULTS / "concave.json").read_text(encoding="utf-8"), encoding="utf-8"
    )
    monkeypatch.setattr(provenance, "RESULTS", tracked)
    monkeypatch.setattr(concave, "RESULTS", tracked)
    monkeypatch.setattr(provenance, "ROOT", tmp_path)
    monkeypatch.setattr(provenance, "ANEW", tmp_path / "anew")
    monkeypatch.setattr(provenance, "RUN", Run())
    monkeypatch.setattr(provenance, "UNSTORED", {})
    monkeypatch.setattr(provenance, "changed_files", list)
    monkeypatch.setattr(provenance, "PAGE", tracked / "RESULTS.md")
    return tmp_path / "anew"


def command(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> None:
    monkeypatch.setattr(sys, "argv", ["benchmarks", *arguments])
    __main__.main()


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("name", STORED)
def test_stored_rows_are_printed_with_their_commits_and_machines(
    name: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(__main__, "import_module", None)  # nothing is run
    command(monkeypatch, name, "--count", "3")
    printed = capsys.readouterr()
    stored = load(name)
    entries = {"": stored} if "commit" in stored else stored
    for key, entry in entries.items():
        assert f"{key}{': ' if key else ''}{entry['commit']}, {entry['cpu']}, " in printed.out
    assert "| --- |" in printed.out
    assert f"python -m tests.benchmarks {name} --again" in printed.err


def test_stored_rows_are_printed_without_what_measures_them() -> None:
    """After README's first command to install, with which no extra comes."""
    code = (
        "import runpy, sys;"
        "sys.modules |= dict.fromkeys(['matplotlib', 'ortools', 'psutil', 'pytest', 'tqdm']);"
        "sys.argv = ['benchmarks', sys.argv[1]];"
        "runpy.run_module('tests.benchmarks', run_name='__main__')"
    )
    for name in ("actors", "tables"):
        command = [sys.executable, "-c", code, name]
        ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, encoding="utf-8")
        assert ran.returncode == 0, ran.stderr
        assert "pa-one" in ran.stdout.lower()


def test_what_is_not_stored_is_said_to_be_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    command(monkeypatch, "start")
    assert capsys.readouterr().out == "Nothing is stored of start.\n"


def test_a_run_changes_no_tracked_file(
    anew: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = contents(provenance.RESULTS)
    monkeypatch.setattr(provenance, "changed_files", lambda: ["service/planner.py"])
    command(monkeypatch, "concave", "--again")
    assert contents(provenance.RESULTS) == before
    assert contents(anew).keys() == {"concave.json", "concave.png"}
    printed = capsys.readouterr()
    assert "| different / rays |" in printed.out
    assert "| 20 | 2 |" in printed.out
    assert "All of it: anew/concave.json" in printed.err


@pytest.mark.usefixtures("anew")
def test_a_run_that_is_told_to_store_writes_tracked_files(monkeypatch: pytest.MonkeyPatch) -> None:
    before = load("concave")
    command(monkeypatch, "--store", "concave")
    written = contents(provenance.RESULTS)
    assert written.keys() == {"concave.json", "concave.png", "RESULTS.md"}
    assert load("concave")["commit"] != before["commit"]


def test_every_benchmark_has_help_of_its_own() -> None:
    command = [sys.executable, "-m", "tests.benchmarks", "actors", "--help"]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, encoding="utf-8")
    assert ended.returncode == 0
    assert "usage: python -m tests.benchmarks actors" in ended.stdout
    assert "--threads" in ended.stdout


@pytest.mark.usefixtures("anew")
def test_a_package_that_is_missing_is_named_with_what_installs_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "psutil", None)
    monkeypatch.delitem(sys.modules, "tests.benchmarks.soak", raising=False)
    monkeypatch.setattr(sys, "argv", ["benchmarks", "soak", "--again"])
    with pytest.raises(SystemExit) as ended:
        __main__.main()
    assert ended.value.code == "soak needs psutil: pip install -e '.[bench,test]'"


def test_rows_that_are_not_stored_are_printed_with_the_reason(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    unstored = {"soak": Unstored({"minutes": 1}, "the stored run is whole")}
    monkeypatch.setattr(provenance, "UNSTORED", unstored)
    monkeypatch.setattr(sys, "argv", ["benchmarks", "tables", "--help"])
    with pytest.raises(SystemExit):
        __main__.main()
    printed = capsys.readouterr()
    assert '"minutes": 1' in printed.out
    assert printed.err == "soak is not stored: the stored run is whole\n"
