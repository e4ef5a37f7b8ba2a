"""The time to a good front is that of the first good one, and its growth is fitted."""

from pathlib import Path

import numpy as np
import pytest

from tests.benchmarks import provenance
from tests.benchmarks.growth_table import exponent

FRONTS = [
    (0.1, np.array([[2.0, 2.0]])),  # the worst corner of the last front's box
    (0.2, np.array([[1.0, 1.5], [1.5, 1.0]])),  # three quarters of the box
    (0.3, np.array([[1.0, 2.0], [0.9, 1.0], [2.0, 0.0]])),
    (0.4, np.array([[1.0, 1.0], [2.0, 0.0]])),
    (0.5, np.array([[0.0, 2.0], [1.0, 1.0], [2.0, 0.0]])),
]


def test_a_front_is_good_from_when_on_it_has_its_share() -> None:
    """In the box to (2, 2) the last front dominates 1, those before 1, 1.1, .75 and 0."""
    growth = pytest.importorskip("tests.benchmarks.growth", reason="needs the extra train")
    assert growth.seconds_to(0.0, FRONTS) == 0.1
    assert growth.seconds_to(0.75, FRONTS) == 0.2
    assert growth.seconds_to(0.99, FRONTS) == 0.3


def test_the_exponent_of_an_exact_law_is_found() -> None:
    cities = np.array([1e3, 1e4, 1e5])
    assert exponent(cities, 3 * cities**1.25) == pytest.approx(1.25)


def test_it_is_measured_stored_and_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    growth = pytest.importorskip("tests.benchmarks.growth", reason="needs the extra train")
    monkeypatch.setattr(provenance, "RESULTS", tmp_path)
    monkeypatch.setattr(provenance, "changed_files", list)
    monkeypatch.setattr(growth, "LIMITS", {50: (0.3,), 100: (0.3,)})
    growth.main([])
    stored = provenance.load("growth")
    assert all(0 < entry["instances"][0]["seconds"] <= 0.5 for entry in stored.values())
    assert "seconds grow as cities^" in capsys.readouterr().out
