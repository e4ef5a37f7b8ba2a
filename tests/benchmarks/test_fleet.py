"""The benchmark of fleets runs from end to end, and ours find plans."""

from pathlib import Path

import pytest

from tests.benchmarks import provenance


def test_plans_are_found_which_are_stored_and_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fleet = pytest.importorskip("tests.benchmarks.fleet", reason="needs the extra bench")
    monkeypatch.setattr(provenance, "RESULTS", tmp_path)
    monkeypatch.setattr(provenance, "changed_files", list)
    monkeypatch.setitem(fleet.SECONDS, 20, 0.5)
    fleet.main(["--sizes", "20", "--count", "1"])
    stored = provenance.load("fleet")
    assert all(len(entry["instances"]) == 1 for entry in stored.values())
    assert len(stored) == 4
    for name in fleet.WITH_NETWORK:  # the others may find nothing in time
        (measured,) = stored[f"20 customers, {name}"]["instances"]
        assert 0.3 < measured["hypervolume"] < 0.6
        assert measured["points"]
    assert "ahead on" in capsys.readouterr().out
