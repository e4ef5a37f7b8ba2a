"""The benchmark of replanning: all ways plan the same rest, and are measured by the same box."""

import json
from typing import Any

import numpy as np
import pytest

from service.instance import Instance, tour_lengths
from service.kinds.parsing import parse_replan
from service.requests import stops as request_stops
from service.requests.limits import Limits
from service.requests.replan.way import ReplanSource
from service.requests.task import TaskSource
from tests.benchmarks.replan import longer_than, removed_and_added, share_of, unmet
from tests.benchmarks.rests import (
    ROADS,
    ROADS_COSTS,
    Rest,
    Stops,
    draw_stops,
    with_costs_changed,
    with_stops_changed,
)
from tests.helpers.actors import info_of
from tests.helpers.changes import Found, front_of

LIMITS = Limits(body_bytes=2**20, cities=60, cells=100, preferences=99, size=99, seconds=9)
N = 30


def drawn(shape: str) -> tuple[Stops, dict[str, Any], Rest]:
    generator = np.random.default_rng(1)
    stops = draw_stops(shape, N, 0 if shape == ROADS_COSTS else 2, generator)
    tours = [[0, *generator.permutation(np.arange(1, N)).tolist()] for _ in range(3)]
    front = {"front": [{"balance": each / 2, "tour": tours[each]} for each in range(3)]}
    if shape == ROADS_COSTS:
        return stops, front, with_costs_changed(stops, front, 2, generator)
    return stops, front, with_stops_changed(stops, front, 2, 2, generator)


def test_a_share_of_the_stops_is_never_more_than_asked_but_for_one_stop() -> None:
    for n in (50, 200, 1000):
        for share in (1, 5, 10):
            for seed in (0, 1):
                changed = sum(removed_and_added(n, share, seed))
                assert changed == 1 or 0.8 <= changed / (n * share / 100) <= 1
    assert {removed_and_added(50, 1, seed) for seed in (0, 1)} == {(1, 0), (0, 1)}


@pytest.mark.parametrize("shape", ["uniform", "clustered", ROADS, ROADS_COSTS])
def test_the_rest_from_nothing_is_that_which_is_replanned(shape: str) -> None:
    stops, front, rest = drawn(shape)
    orders = np.array([each["tour"] for each in front["front"]])
    source = TaskSource("front", json.dumps(stops.request(range(N))).encode())
    stored = front_of(source, Found(orders, np.ones((len(orders), 2))))
    body = json.dumps(rest.changes).encode()
    task = parse_replan(ReplanSource(body, stored), LIMITS, {"a": info_of("a", "matrices")})
    assert isinstance(task.subject, request_stops.Stops)
    instance = task.subject.instance
    one, other = (_costs_by_kind(each) for each in (instance, rest.instance))
    for costs, others in zip(one, other, strict=True):
        np.testing.assert_allclose(costs, others)
    assert (np.sort(rest.hints) == np.arange(instance.n)).all()
    assert set(rest.hints[:, 0]) == {rest.instance.start}


def _costs_by_kind(instance: Instance) -> tuple[np.ndarray, ...]:
    """All costs of an instance, those from its start and those to its end, each sorted."""
    costs = instance.scaled_matrices
    kinds = (costs, costs[:, instance.start], costs[:, :, instance.end])
    return tuple(np.sort(each.reshape(2, -1)) for each in kinds)


def test_or_tools_makes_no_hint_longer() -> None:
    rival = pytest.importorskip("tests.benchmarks.rivals.ortools_routing")
    _, _, rest = drawn(ROADS)
    routes = rival.improved_routes(rest.instance.scaled_matrices, rest.hints, 0.3)
    assert (np.sort(routes) == np.arange(rest.instance.n)).all()
    assert {(route[0], route[-1]) for route in routes} == {(0, rest.instance.n - 1)}
    hints, improved = (
        tour_lengths(rest.instance, each)[:, 0].min() for each in (rest.hints, routes)
    )
    assert improved <= hints


def test_the_share_of_a_front_is_that_of_its_hypervolume_in_its_own_box() -> None:
    best = np.array([[0.0, 4.0], [2.0, 2.0], [4.0, 0.0]])
    assert share_of(best, best) == pytest.approx(1.0)
    assert share_of(best[:1], best) == pytest.approx(0.0, abs=1e-6)
    assert share_of(best + np.array([0.0, 1.0]), best) == pytest.approx(0.5)
    assert share_of(best - 1.0, best) > 1.0


def test_a_front_of_one_point_is_reached_or_missed() -> None:
    best = np.array([[3.0, 4.0]])
    assert share_of(best, best) == pytest.approx(1.0)
    assert share_of(best * 1.01, best) == 0.0


def test_a_tour_is_longer_by_its_excess_over_the_front_in_its_direction() -> None:
    best = np.array([[1.0, 4.0], [2.0, 2.0], [3.0, 1.8]])
    assert longer_than(np.array([2.2, 2.2]), best) == pytest.approx(0.1)
    assert longer_than(np.array([1.1, 4.4]), best) == pytest.approx(0.1)
    assert longer_than(np.array([0.9, 3.6]), best) == 0
    # Between two points of the front: neither is it longer there than both, nor shorter.
    assert 0 < longer_than(np.array([2.6, 2.1]), best) < 0.1


def test_what_does_not_hold_is_said() -> None:
    def entry(share: float, other: float, kept: float, longer: float) -> dict[str, Any]:
        alike = {"kept": kept, "longer": longer}
        cells = {
            f"{name}, {limit} s": {"share": value, **alike}
            for limit in (0.1, 0.5)
            for name, value in (("replanned", share), ("from nothing", other))
        }
        return {"instances": [cells]}

    assert not list(unmet({"200 stops, uniform, 10 %": entry(0.995, 0.99, 0.2, 0.2)}))
    assert len(list(unmet({"200 stops, uniform, 10 %": entry(0.98, 0.99, 1, 0)}))) == 2
    assert not list(unmet({"1000 stops, uniform, 1 %": entry(0.995, 0.99, 0.9, 0)}))
    assert len(list(unmet({"1000 stops, uniform, 1 %": entry(0.98, 0.99, 0.8, 0.1)}))) == 4
