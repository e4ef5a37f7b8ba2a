"""Times that vary from day to day: how the page asks for them, and what it says of plans."""

import json
from typing import Any

import pytest

from service.requests.fleet import parse_fleet_request
from tests.helpers.fleet_requests import LIMITS
from tests.helpers.node import Node

MINUTES = [[0, 6, 9], [6, 0, 4], [9, 4, 0]]
NINE = 9 * 3600
AT = [[24.94, 60.17], [24.95, 60.17], [24.96, 60.18]]
FLEET: dict[str, Any] = {
    "stops": [
        {"id": "depot", "location": AT[0]},
        {"id": "a", "location": AT[1], "window": [8 * 3600, NINE]},
        {"id": "b", "location": AT[2], "due": NINE},
    ],
    "vehicles": [{"id": "van", "count": 2, "start": "depot", "end": "depot"}],
}
METRES = {"name": "distance", "from": "great_circle"}
SECONDS = {"name": "time", "from": "great_circle", "speed": 30}
TABLE = {"name": "time", "unit": "min", "matrix": MINUTES}
DAYS = {"name": "time", "unit": "min", "days": [{"matrix": MINUTES}] * 2}
RUSH = {**SECONDS, "over_the_day": [[25200, 1.0], [27000, 1.6]]}
VANS = {"name": "vans", "measure": "vehicles"}
LONGEST = {"over": "max", "name": "longest route"}


def fleet(*objectives: dict[str, Any], clock: Any = None) -> dict[str, Any]:
    """Return a fleet with these objectives."""
    return {**FLEET, "objectives": list(objectives), **({"clock": clock} if clock else {})}


FLEETS = {
    "straight": fleet(METRES, {**SECONDS, "over": "max"}, clock="time"),
    "metres": fleet(METRES, {**METRES, **LONGEST}),
    "times of their own": fleet(METRES, VANS, clock=SECONDS),
    "minutes": fleet(TABLE, VANS, clock="time"),
    "minutes that are no times yet": fleet(TABLE, VANS),
    "one total and its longest": fleet(TABLE, {**TABLE, **LONGEST}, clock="time"),
    "rush hours": fleet(METRES, RUSH, clock="time"),
    "already": fleet({**TABLE, "spread": 0.3, "percentile": 90}, VANS, clock="time"),
    "three": fleet(METRES, SECONDS, VANS, clock="time"),
    "days": fleet(DAYS, VANS, clock="time"),
}
VARIES = {"already": 30, "days": "days"}  # in per cent; 20 where nothing is said
STEPS = """async ([asked, steps]) => {
  const modules = ["fleet/spread.js", "fleet/trade.js", "inputs/day.js", "inputs/stops.js"];
  const loaded = await Promise.all(modules.map((each) => import(`./page/${each}`)));
  const found = Object.assign({}, ...loaded);
  const end = steps.reduce((before, [name, ...given]) => found[name](before, ...given), asked);
  const varies = found.variesBy(end);
  return [end, varies === undefined ? "days" : varies];
}"""


def after(node: Node, asked: dict[str, Any], *steps: tuple[Any, ...]) -> tuple[Any, Any]:
    """Return a request after these changes, and by how many per cent its times vary."""
    end, varies = node.evaluate(STEPS, [asked, steps])
    return end, varies


def check(asked: dict[str, Any]) -> None:
    """Raise what the service refuses about a fleet."""
    parse_fleet_request(json.dumps(asked).encode(), LIMITS).subject()


@pytest.mark.parametrize("trade", ["tradedAgainst", "tradedAlsoAgainst"])
@pytest.mark.parametrize("name", FLEETS)
def test_late_visits_can_be_traded_in_any_fleet_with_windows(
    node: Node, name: str, trade: str
) -> None:
    """The service takes what the page asks for, also when something else is traded again."""
    asked, varies = after(node, FLEETS[name], (trade, "on_time"))
    assert varies == VARIES.get(name, 20)
    late = {"name": "late visits", "measure": "on_time"}
    assert asked["objectives"][1 if trade == "tradedAgainst" else 2] == late
    check(asked)
    for key in ("max", "sum", "overlap"):
        others, varies = after(node, asked, (trade, key))
        assert varies == VARIES.get(name, 20)
        if trade == "tradedAgainst" or key in dict(
            node.call("fleet/trade.js", "alsoAgainst", asked)
        ):
            check(others)


@pytest.mark.parametrize("times", ["first", "second", "own"])
def test_other_times_vary_as_those_before(node: Node, times: str) -> None:
    before = fleet(SECONDS, VANS if times == "own" else METRES, clock="time")
    asked, varies = after(node, before, ("varyingBy", 35), ("timedBy", times))
    assert varies == 35
    check(asked)
    assert after(node, asked, ("timedBy", None), ("timedBy", times))[1] is None
    assert after(node, asked, ("varyingBy", None)) == after(node, before, ("timedBy", times))


def test_rush_hours_stay_those_of_all_objectives_that_are_measured_alike(node: Node) -> None:
    """Otherwise a total would be driven at other times than its longest route."""
    asked, _ = after(
        node,
        fleet(SECONDS, {**SECONDS, **LONGEST}, clock="time"),
        ("varyingBy", 20),
        ("changingOver", [[25200, 1.0], [27000, 1.6]]),
    )
    assert all(each["over_the_day"] for each in asked["objectives"])
    check(asked)


@pytest.mark.parametrize(
    ("text", "percent"),
    [
        *[("20", 20), ("20 %", 20), (" 12,5% ", 12.5), ("0", 0), ("1000", 1000), ("", None)],
        *[(text, "?") for text in ("1001", "-5", "a lot", "2e1", "20 % %", "1/3", "Infinity")],
    ],
)
def test_per_cent_are_read_as_people_write_them(node: Node, text: str, percent: object) -> None:
    source = """async (text) => {
      const found = (await import("./page/fleet/spread.js")).percentTyped(text);
      return found === undefined ? "?" : found;
    }"""
    assert node.evaluate(source, text) == percent


@pytest.mark.parametrize(
    ("share", "said"),
    [
        (0, "0"),
        (0.456, "46"),
        (0.9876, "99"),
        (0.994, "99.4"),
        (0.99951, "more than 99.9"),
        (1, "100"),
    ],
)
def test_a_plan_says_how_surely_it_is_on_time(node: Node, share: float, said: str) -> None:
    found = node.call("fleet/spread.js", "onTimeSaid", {"measures": {"on_time": share}})
    assert found.startswith(f" On an average day, {said} % of the visits")
    assert node.call("fleet/spread.js", "onTimeSaid", {"measures": {"vehicles": 2}}) == ""
    assert node.call("fleet/spread.js", "onTimeSaid", {}) == ""


def test_a_stop_is_deleted_with_its_costs_of_every_form(node: Node) -> None:
    """Costs of days and of profiles, and matrices of spread, keep a row for each stop."""
    slices = [{"from": 0, "matrix": MINUTES}, {"from": 60, "matrix": MINUTES}]
    profiles = [{"profile": "car", "matrix": MINUTES}, {"profile": "truck", "slices": slices}]
    objectives = [
        {**TABLE, "spread": MINUTES},
        DAYS,
        {"name": "by profile", "matrices": profiles},
        {**SECONDS, "spread": 0.2},
    ]
    left = after(node, fleet(*objectives), ("without", 1))[0]["objectives"]
    kept = [[0, 9], [9, 0]]
    assert (left[0]["matrix"], left[0]["spread"]) == (kept, kept)
    assert left[1]["days"] == [{"matrix": kept}] * 2
    truck = [{**each, "matrix": kept} for each in slices]
    assert left[2]["matrices"] == [
        {"profile": "car", "matrix": kept},
        {"profile": "truck", "slices": truck},
    ]
    assert left[3] == objectives[3]
