"""The benchmark of weights: what OR-Tools is given, what is measured, and its table."""

from pathlib import Path

import numpy as np
import pytest

from service.instance import Instance, tour_lengths
from service.pareto import nondominated
from tests.benchmarks import provenance, weights_table
from tests.helpers.instances import all_tours


def test_guided_search_finds_the_shortest_tour_under_every_weight() -> None:
    weights = pytest.importorskip("tests.benchmarks.weights", reason="needs the extra bench")
    instance = Instance(matrices=np.random.default_rng(1).random((2, 6, 6)))
    found = tour_lengths(instance, weights._by_weights(3, 0.3, instance, 0)) / instance.scale
    every = tour_lengths(instance, all_tours(6)) / instance.scale
    for lengths, share in zip(found, np.linspace(0.001, 0.999, 3), strict=True):
        weighted = np.array([1 - share, share])
        assert lengths @ weighted == pytest.approx((every @ weighted).min(), rel=1e-5)


def test_points_that_another_beats_are_not_measured() -> None:
    weights = pytest.importorskip("tests.benchmarks.weights", reason="needs the extra bench")
    first = np.array([[0, 1, 9], [9, 0, 1], [1, 9, 0]], float)  # one way round is better
    instance = Instance(matrices=np.stack([first, 2 * first]))
    tours = np.array([[0, 2, 1], [0, 1, 2], [1, 2, 0]])
    assert weights.measured(lambda *_: tours, instance, 0)["points"] == [[3.0, 6.0]]


def test_the_table_has_medians_and_the_least_within_each_budget(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(provenance, "RESULTS", tmp_path)
    monkeypatch.setattr(provenance, "changed_files", list)
    assert weights_table.weights_table() == "Not measured.\n"
    place = {"cpu": "abacus", "date": "today", "commit": "none", "busy": 0.5}
    whole = [[100.0, 40.0], [104.0, 20.0], [110.0, 10.0]]
    rounds = [{"seconds": seconds, "points": whole} for seconds in (0.2, 0.3, 9.0)]
    middle = [{"seconds": 1.0, "points": [[104.0, 20.0]]}] * 3
    entries = {"1 s: ours": rounds, "1 s: theirs": middle}
    stored = {key: {**place, "instances": each} for key, each in entries.items()}
    provenance.store("weights", stored)
    text = weights_table.weights_table()
    assert "| 1 s | ours | 0.3 | 3 | 100.0 % | 40 | 20 | 10 |" in text
    # Scaled, (0.4, 1/3) of (0, 1), (0.4, 1/3), (1, 0), with the corner (1.1, 1.1).
    assert "| 1 s | theirs | 1.0 | 1 | 88.0 % | none | 20 | 20 |" in text
    assert "has 3 tours. 3 of them are best under some weight." in text
    assert "the median of 3 rounds. Measured on abacus, today, `none`, one thread." in text


def test_points_in_a_dent_are_best_under_no_weight() -> None:
    rng = np.random.default_rng(5)
    points = rng.random((40, 2))
    front = points[nondominated(points)]
    shares = np.linspace(0, 1, 20001)
    best = {int((share * front[:, 0] + (1 - share) * front[:, 1]).argmin()) for share in shares}
    assert 2 < weights_table._supported(front) == len(best) < len(front)


def test_three_weights_find_both_ends_of_the_stored_front_in_ten_seconds() -> None:
    stored = provenance.load("weights")
    best = weights_table._together(stored)
    for round_ in stored["10 s: OR-Tools, 3 weights"]["instances"]:
        assert np.array_equal(np.min(round_["points"], axis=0), best.min(axis=0))
