"""The benchmark of open routes: what it measures, and its table."""

import numpy as np
import pytest

from service.instance import Instance
from tests.benchmarks import open_routes, provenance


def test_a_search_that_converges_finds_the_same_within_both_limits() -> None:
    cities = np.random.default_rng(2).random((10, 4))
    closed, opened = (Instance(coordinates=cities, closed=closed) for closed in (True, False))
    first, second = open_routes.shares(closed, (5.0, 6.0))
    assert 0 < first == second < 100
    assert open_routes.shares(opened, (5.0,)) > [first]


def test_the_table_says_how_far_the_shorter_limit_is_below(
    tmp_path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(provenance, "RESULTS", tmp_path)
    monkeypatch.setattr(provenance, "changed_files", list)
    assert "Not measured." in open_routes.section()
    entry = {"busy": 0.5, "instances": [[87.0, 87.1], [86.0, 86.2]]}
    provenance.store("open_routes", {"free ends": entry})
    assert "| free ends | 86.50 | 86.65 | 0.150 | 2 | 0.5 |" in open_routes.section()
