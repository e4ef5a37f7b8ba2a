"""Objectives whose costs spread: what they become, and every refusal."""

from typing import Any

import numpy as np
import pytest

from service.errors import Refusal
from service.reliability.spread import percentiles
from service.requests.front import parse_front_request
from tests.requests.test_stops import COSTS, LIMITS, PLANE, RISK, WAY, body

DAYS = [{"matrix": COSTS}, {"matrix": (3 * np.array(COSTS)).tolist()}]


def stops_of(*objectives: dict[str, Any], **members: Any) -> Any:
    return parse_front_request(body(objectives=objectives, **members), LIMITS).subject


def test_the_costs_of_days_are_their_mean() -> None:
    stops = stops_of(WAY, {"name": "time", "days": DAYS, "percentile": 90})
    np.testing.assert_array_equal(stops.sources[1].costs, 2 * np.array(COSTS))
    assert (stops.kind, percentiles(stops.spreads), stops.spreads[0]) == ("matrices", 1, None)
    assert stops.spreads[1].days.shape == (2, 4, 4)


def test_planes_that_spread_become_matrices() -> None:
    stops = stops_of({**PLANE, "spread": 0.2}, {**PLANE, "name": "b"})
    assert (stops.instance.kind, percentiles(stops.spreads)) == ("matrices", 0)


SURE = {**RISK, "percentile": 90}
LIKELY = {**RISK, "spread": 0.3, "percentile": 90}
ITEMS = {
    "/objectives/0/percentile": [SURE, WAY],
    "/objectives/0/spread": [{"name": "t", "days": DAYS, "spread": 0.1}, WAY],
    "/objectives/0/days": [{"name": "t", "days": DAYS[:1]}, WAY],
    "/objectives/0/days/1/matrix": [{"name": "t", "days": [DAYS[0], {"matrix": [[0]]}]}, WAY],
    "/objectives/1/spread": [WAY, {**RISK, "spread": [[0, 1], [1, 0]]}],
    "/objectives/1/spread ": [WAY, {**RISK, "spread": -1}],
    "/objectives/2/percentile": [WAY, {**LIKELY, "name": "a"}, {**LIKELY, "name": "b"}],
}


@pytest.mark.parametrize("pointer", ITEMS)
def test_what_cannot_spread_is_named(pointer: str) -> None:
    with pytest.raises(Refusal) as refused:
        stops_of(*ITEMS[pointer])
    assert refused.value.errors[0].pointer == pointer.strip()


@pytest.mark.parametrize("members", [{"bound": True}, {"departure": 0}])
def test_a_bound_and_times_of_the_day_do_not_go_with_a_spread(members: dict[str, Any]) -> None:
    with pytest.raises(Refusal) as refused:
        stops_of(WAY, {**LIKELY, "unit": "s"}, **members)
    assert refused.value.errors[0].pointer == f"/{next(iter(members))}"


def test_costs_do_not_both_spread_and_change_over_the_day() -> None:
    changing = {**LIKELY, "unit": "s", "over_the_day": [[0, 1], [9, 2]]}
    with pytest.raises(Refusal) as refused:
        stops_of(WAY, changing, departure=0)
    assert refused.value.errors[0].pointer == "/objectives/1/spread"
