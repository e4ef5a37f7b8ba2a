"""The hour of a researcher: many instances, a search of one's own, and the stored rows."""

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tests.first_hours.steps import command, run_program, says, write_files
from tests.helpers.command import ROOT, paretour
from tests.test_extensions import guide_package

EXTENSIONS = "use-your-own-constructor-or-search"


def test_instances_are_planned_a_search_is_compared_and_rows_are_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    many = run_program("use-it-as-a-library", "plan_many", tmp_path)
    assert len(many["fronts"]) == len(many["instances"])
    assert all(0 < front.hypervolume < 1 for front in many["fronts"])

    packages = tmp_path / "packages"
    packages.mkdir()
    monkeypatch.syspath_prepend(packages)
    monkeypatch.setenv("PYTHONPATH", str(packages))
    write_files(EXTENSIONS, tmp_path, "my-request.json")
    says(EXTENSIONS, "the command `paretour` read the same two variables.")
    with guide_package(packages) as named:
        started = command(EXTENSIONS, "paretour serve").split()
        assert started[:2] == [f"{name}={value}" for name, value in named.items()]
        own = paretour("front", "my-request.json", "--json", folder=tmp_path, **named)
    found = json.loads(own.stdout)
    assert found["actor"]["name"] == "my-nearest"
    request = json.loads((tmp_path / "my-request.json").read_text())
    (tmp_path / "plain.json").write_text(
        json.dumps({**request, "actor": "pa-one", "time_limit": 30})
    )
    plain = json.loads(paretour("front", "plain.json", "--json", folder=tmp_path).stdout)
    # Of six cities Paretour's front is exact.
    assert plain["terminated"] == "converged"
    assert 0 < found["hypervolume"] <= plain["hypervolume"] + 1e-9

    says("how-good-is-it", "prints the stored rows in tables, with their commit, machine and date.")
    text = (ROOT / "service/guide/how-good-is-it.md").read_text()
    [benchmark, *_] = re.findall(r"`python -m (tests\.benchmarks search [^`]+)`", text)
    rows = subprocess.run(
        [sys.executable, "-m", *shlex.split(benchmark)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    [hypervolume] = re.findall(r"^\| 40, \(40, 40\) \| OR-Tools, no limit .*\| (\S+) ±", text, re.M)
    [row] = re.findall(r"^\| 40 OR-Tools, no limit, 0 \|.*$", rows, re.M)
    assert re.search(r"^40 OR-Tools, no limit: .*, threads \d+, \d{4}-\d\d-\d\d$", rows, re.M)
    assert f"{float(row.split(' | ')[3].split()[0]):.2f}" == hypervolume

    # A test of its own trains by the commands of this page.
    says("train-your-own-actor", ".venv/bin/python -m models.train")
