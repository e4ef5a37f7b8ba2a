"""Stored results are of whole runs, at commits that there are."""

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.benchmarks import provenance
from tests.benchmarks.provenance import RESULTS, ROOT, UNSTORED, load, store

WHOLE = {
    "commit": "abc",
    "rows": {"one": {"40": {"instances": 25, "share": 0.7}}, "two": {"instances": [1, 2, 3]}},
}


def changed(results: Any, name: str, value: Any) -> Any:
    """Return results with another value wherever they have this name."""
    if isinstance(results, dict):
        return {k: value if k == name else changed(v, name, value) for k, v in results.items()}
    return results


@pytest.fixture
def clean(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A tree without changes, and an empty folder of results."""
    monkeypatch.setattr(provenance, "RESULTS", tmp_path)
    monkeypatch.setattr(provenance, "changed_files", list)
    monkeypatch.setattr(provenance, "UNSTORED", UNSTORED)
    UNSTORED.clear()


PARTIAL = [
    ({"commit": "abc", "rows": {"one": WHOLE["rows"]["one"]}}, "/rows/two"),  # type: ignore[index]
    (changed(WHOLE, "40", {"instances": 2, "share": 0.9}), "/rows/one/40/instances 25, got 2"),
    (changed(WHOLE, "two", {"instances": [9]}), "/rows/two/instances 3, got 1"),
]


@pytest.mark.usefixtures("clean")
@pytest.mark.parametrize(("results", "lacking"), PARTIAL)
def test_a_partial_run_is_not_stored_over_a_whole_one(
    results: dict[str, Any], lacking: str
) -> None:
    store("actors", WHOLE)
    store("actors", results)
    assert load("actors") == WHOLE
    assert UNSTORED["actors"].reason == f"the run lacks what is stored: {lacking}"
    assert UNSTORED["actors"].rows == {"rows": results["rows"]}


@pytest.mark.usefixtures("clean")
def test_a_run_that_says_it_is_partial_is_not_stored_over_a_whole_one() -> None:
    store("load", {"answers": 1}, partial="2 rounds")
    store("load", {"answers": 2})
    store("load", {"answers": 3}, partial="2 rounds")
    assert load("load") == {"answers": 2}
    assert "2 rounds" in UNSTORED["load"].reason


@pytest.mark.usefixtures("clean")
def test_a_whole_run_is_stored_over_another() -> None:
    store("actors", WHOLE)
    store("actors", changed(WHOLE, "share", 0.6))
    assert load("actors") == changed(WHOLE, "share", 0.6)
    assert not UNSTORED


@pytest.mark.usefixtures("clean")
def test_a_whole_run_need_not_fail_as_the_stored_one_did() -> None:
    store("attack", {"commit": "abc", "tracebacks": {"OSError": 2}, "statuses": {"200": 1}})
    better = {"commit": "def", "tracebacks": {}, "statuses": {"503": 1}}
    store("attack", better)
    assert load("attack") == better


@pytest.mark.usefixtures("clean")
def test_a_run_of_code_that_is_no_commit_is_not_stored(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(provenance, "changed_files", lambda: ["service/planner.py"])
    store("actors", WHOLE)
    assert load("actors") == {}
    assert "service/planner.py changed" in UNSTORED["actors"].reason


def test_results_themselves_do_not_make_the_code_another(tmp_path: Path, monkeypatch: Any) -> None:
    for folder in ("tests/benchmarks/results", "service"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "a.json").write_text("{}", encoding="utf-8")
    git = ["git", "-c", "user.name=a", "-c", "user.email=a@b", "-C", str(tmp_path)]
    for command in (["init", "-q"], ["add", "."], ["commit", "-q", "-m", "All"]):
        subprocess.run([*git, *command], check=True)
    monkeypatch.setattr(provenance, "ROOT", tmp_path)
    (tmp_path / "tests/benchmarks/results/a.json").write_text("{1}", encoding="utf-8")
    assert provenance.changed_files() == []
    (tmp_path / "service/a.json").write_text("{1}", encoding="utf-8")
    assert provenance.changed_files() == ["service/a.json"]


def test_stored_results_name_commits_that_there_are() -> None:
    def git(*arguments: str) -> str:
        command = ["git", *arguments]
        return subprocess.run(
            command, cwd=ROOT, capture_output=True, text=True, encoding="utf-8"
        ).stdout.strip()

    if git("rev-parse", "--is-shallow-repository") != "false":
        pytest.skip("not all commits are here")
    commits = set(git("log", "--format=%H").split())
    named = {
        commit
        for path in RESULTS.glob("*.json")
        for commit in re.findall(r'"commit": "([^"-]*)', path.read_text(encoding="utf-8"))
    }
    assert len(named) > 20
    missing = [name for name in named if not any(commit.startswith(name) for commit in commits)]
    assert missing == []


def test_every_result_is_json() -> None:
    for path in RESULTS.glob("*.json"):
        assert isinstance(json.loads(path.read_text(encoding="utf-8")), dict)
