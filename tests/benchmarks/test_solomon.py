"""The benchmark of Solomon's instances reads his format, and is right about their lengths."""

from pathlib import Path

import numpy as np
import pytest

from tests.benchmarks import provenance

INSTANCE = """T1

VEHICLE
NUMBER     CAPACITY
  3         10

CUSTOMER
CUST NO.  XCOORD.   YCOORD.    DEMAND   READY TIME  DUE DATE   SERVICE TIME

    0      0         0          0       0         40           0
    1      3         4          5       10        20           2
    2      6         8          5       0         30           2
    3      1         1          6       0         30           2
"""


def test_a_front_of_an_instance_is_stored_and_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """By hand: 1 and 2 fit a vehicle, 3 does not; who serves 2 after 1 is under way for 24."""
    solomon = pytest.importorskip("tests.benchmarks.solomon", reason="needs the extra bench")
    monkeypatch.setattr(provenance, "RESULTS", tmp_path / "results")
    monkeypatch.setattr(provenance, "changed_files", list)
    monkeypatch.setattr(solomon, "SECONDS", 0.5)
    (tmp_path / "T1.txt").write_text(INSTANCE, encoding="utf-8")
    (tmp_path / "T1.sol").write_text("Route #1: 1 2\nRoute #2: 3\nCost 22.8\n", encoding="utf-8")
    solomon.main(["--data", str(tmp_path)])
    stored = provenance.load("solomon")
    assert set(stored) == {"T1, paretour", "T1, plain PyVRP sweep"}
    (measured,) = stored["T1, paretour"]["instances"]
    assert measured["best_known"] == 22.8
    np.testing.assert_allclose(measured["points"], [[22.8, 24.0], [32.8, 22.0]])
    assert (
        "2 plans, distance from 22.8 (+0.0 %), longest route from 22.0" in capsys.readouterr().out
    )
