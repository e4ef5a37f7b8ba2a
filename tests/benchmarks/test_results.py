"""RESULTS.md is what the renderer makes of the stored results."""

import sys

import pytest

from tests.benchmarks import __main__, printed, provenance, render
from tests.benchmarks.instances import SIZES


def test_the_page_is_what_the_renderer_makes_of_the_stored_results() -> None:
    assert provenance.PAGE.read_text(encoding="utf-8") == render.page()


def test_every_printed_row_is_on_the_page_beside_ours() -> None:
    lines = provenance.PAGE.read_text(encoding="utf-8").splitlines()
    for row, shares in printed.HYPERVOLUME.items():
        for share, seconds in zip(shares, printed.SECONDS[row], strict=True):
            found = [line for line in lines if line.startswith(f"| {row} | {share} | ")]
            assert sum(f" | {seconds} | " in line for line in found) == 1
        assert len(shares) == len(SIZES)


def test_the_command_writes_the_page_of_other_results(
    tmp_path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(provenance, "RESULTS", tmp_path)
    monkeypatch.setattr(provenance, "changed_files", list)
    monkeypatch.setattr(provenance, "PAGE", tmp_path / "RESULTS.md")
    share = {"(40, 40)": 60.0, "(50, 50)": 70.0}
    where = {"cpu": "abacus", "date": "today", "commit": "none", "busy": 2.0}
    entry = {**where, "instances": [{"seconds": 1.5, "hypervolume": share}]}
    provenance.store("networks", {"40 PA-AT": entry})
    monkeypatch.setattr(sys, "argv", ["benchmarks", "tables", "--store", "--render"])
    __main__.main()
    page = (tmp_path / "RESULTS.md").read_text(encoding="utf-8")
    assert "| PA-AT | 74.18 | 70.00 | 60.00 | 2.6 | 1.5\\* | 1 |" in page
    assert "Below the printed hypervolume: PA-AT at 40 cities by 4.18." in page
    assert "Measured on: abacus, today." in page
