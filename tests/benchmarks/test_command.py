"""`python -m tests.benchmarks`: help, and packages that are not installed."""

import subprocess
import sys

import pytest

from tests.benchmarks import __main__, provenance
from tests.benchmarks.provenance import ROOT, Unstored


def test_every_benchmark_has_help_of_its_own() -> None:
    command = [sys.executable, "-m", "tests.benchmarks", "actors", "--help"]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert ended.returncode == 0
    assert "usage: python -m tests.benchmarks actors" in ended.stdout
    assert "--threads" in ended.stdout


def test_a_package_that_is_missing_is_named_with_what_installs_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "psutil", None)
    monkeypatch.delitem(sys.modules, "tests.benchmarks.soak", raising=False)
    monkeypatch.setattr(sys, "argv", ["benchmarks", "soak"])
    with pytest.raises(SystemExit) as ended:
        __main__.main()
    assert ended.value.code == "soak needs psutil: pip install -e '.[bench,train]'"


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
