"""POST /fleet with the bounds and measures of dispatchers, against a live server."""

from itertools import pairwise
from typing import Any

import httpx
import pytest

from tests.helpers.straight_lines import metres_between

SPEED = 30 / 3.6  # metres in a second
HOURS = 3600.0
DEPOTS = {"depot", "kiosk"}


def request(measure: str | None = "lateness", **members: Any) -> dict[str, Any]:
    """Return a request of ten orders with all bounds; two days, two trips, two kinds of vans."""
    places = [[24.93 + 0.01 * (i % 4), 60.16 + 0.008 * (i // 4)] for i in range(12)]
    orders = [
        {"id": f"order-{i}", "location": places[i], "demand": [1 + i % 3], "service": 120}
        for i in range(1, 11)
    ]
    orders[0]["windows"] = [[9 * HOURS, 9.5 * HOURS], [33 * HOURS, 35 * HOURS]]
    orders[1]["skills"] = ["cold"]
    orders[2]["vehicle"] = "bike"
    orders[3]["release"] = 10 * HOURS
    for order in orders[4:8]:
        order["due"] = 9.2 * HOURS
    orders[8]["prize"] = 900
    first = {"name": "distance", "from": "great_circle"}
    second = {"name": "time", "from": "great_circle", "speed": 30}
    return {
        "stops": [
            {"id": "depot", "location": places[0]},
            *orders,
            {"id": "kiosk", "location": places[11]},
        ],
        "vehicles": [
            {
                "id": "van",
                "start": "depot",
                "end": "depot",
                "capacity": [6],
                "skills": ["cold"],
                "shifts": [[9 * HOURS, 12 * HOURS], [33 * HOURS, 36 * HOURS]],
                "reload": ["depot", "kiosk"],
                "max_trips": 2,
            },
            {
                "id": "bike",
                "count": 2,
                "start": "depot",
                "end": "depot",
                "capacity": [6],
                "initial_load": [1],
                "shift": [9 * HOURS, 12 * HOURS],
                "max_overtime": 600,
                "max_stops": 3,
                "breaks": [{"window": [9.2 * HOURS, 9.4 * HOURS], "length": 300}],
            },
        ],
        "objectives": [first, second if measure is None else {"name": measure, "measure": measure}],
        "clock": "time" if measure is None else second,
        "time_limit": 0.2,
        **members,
    }


@pytest.mark.parametrize("measure", [None, "vehicles", "unassigned", "overtime", "lateness"])
def test_plans_keep_all_bounds_and_say_their_measures(
    client: httpx.Client, measure: str | None
) -> None:
    asked = request(measure)
    response = client.post("/fleet", json=asked)
    assert response.status_code == 200, response.text
    answer = response.json()
    stops = {stop["id"]: stop for stop in asked["stops"]}
    assert answer["front"]
    assert answer["objectives"][1].get("measure") == measure
    for plan in answer["front"]:
        late = 0.0
        for route in plan["routes"]:
            check_route(stops, route)
            late += sum(
                max(0.0, max(at, opened(stops[stop], at)) - stops[stop].get("due", at))
                for stop, at in zip(route["stops"], route["arrivals"], strict=True)
            )
        visited = [s for r in plan["routes"] for s in r["stops"] if s not in DEPOTS]
        assert sorted([*visited, *plan["unassigned"]]) == sorted(set(stops) - DEPOTS)
        assert plan["measures"]["vehicles"] == len(plan["routes"])
        assert plan["measures"]["lateness"] == pytest.approx(late, abs=1e-6)
        assert plan["measures"]["unassigned"] == 900 * len(plan["unassigned"])
        if measure is not None:
            assert plan["lengths"][1] == pytest.approx(plan["measures"][measure], abs=1e-6)


def opened(stop: dict[str, Any], arrival: float) -> float:
    """Return when a visit may begin after an arrival."""
    windows = stop.get("windows", [[0.0, float("inf")]])
    return max(arrival, next(opens for opens, closes in windows if closes >= arrival))


def check_route(stops: dict[str, Any], route: dict[str, Any]) -> None:
    """Check that a route keeps the bounds of its vehicle and of its stops."""
    visited = [stop for stop in route["stops"][1:-1] if stop not in DEPOTS]
    is_van = route["vehicle"] == "van"
    assert ("shift" in route) == is_van
    assert is_van or (len(visited) <= 3 and not {"order-2"} & set(visited))
    assert not is_van or "order-3" not in visited
    trips: list[list[str]] = [[]]
    for stop in route["stops"][1:-1]:
        if stop in DEPOTS:
            trips.append([])
        else:
            trips[-1].append(stop)
    assert len(trips) <= (2 if is_van else 1)
    for trip in trips:
        assert sum(stops[stop]["demand"][0] for stop in trip) <= (6 if is_van else 5)
    begin = (33 if route.get("shift") else 9) * HOURS
    over = 0 if is_van else 600
    assert begin - 1e-6 <= route["arrivals"][0]
    assert route["arrivals"][-1] <= begin + 3 * HOURS + over + 1e-6
    columns = zip(route["stops"], route["arrivals"], strict=True)
    for (a, left), (b, arrived) in pairwise(columns):
        metres = metres_between(stops[a]["location"], stops[b]["location"])
        served = opened(stops[a], left) + stops[a].get("service", 0)
        assert arrived >= served + metres / SPEED - 1e-6
    check_break(stops, route)
    loaded = route["arrivals"][0]
    for stop, arrived in zip(route["stops"], route["arrivals"], strict=True):
        loaded = arrived if stop in DEPOTS else loaded
        metres = metres_between(stops["depot"]["location"], stops[stop]["location"])
        if "release" in stops[stop] and len(trips) == 1:
            assert loaded >= stops[stop]["release"] - 1e-6


def check_break(stops: dict[str, Any], route: dict[str, Any]) -> None:
    """Check that the driver of a bike stands still for 300 s from 9.2 to 9.4 hours on."""
    begins = route.get("breaks", [])
    leaves, ends = route["arrivals"][0], route["arrivals"][-1]
    if route["vehicle"] == "van" or leaves >= 9.2 * HOURS + 300 or ends <= 9.4 * HOURS:
        assert not begins
        return
    (begin,) = begins
    assert 9.2 * HOURS <= begin <= 9.4 * HOURS
    ways = zip(pairwise(route["stops"]), pairwise(route["arrivals"]), strict=True)
    for (a, b), (_, arrived) in ways:
        driving = metres_between(stops[a]["location"], stops[b]["location"]) / SPEED
        assert begin >= arrived - 1e-6 or begin + 300 <= arrived - driving + 1e-6


REFUSED = [
    ({"clock": None}, "/vehicles/0/shift"),
    ({"clock": "distance", "objectives": 2}, None),
    ({"stops": {3: {"vehicle": "lorry"}}}, "/stops/3/vehicle"),
    ({"stops": {1: {"window": [0, 1]}}}, "/stops/1/window"),
    ({"stops": {1: {"windows": [[5, 6], [1, 2]]}}}, "/stops/1/windows/1"),
    ({"stops": {0: {"skills": ["cold"]}}}, "/stops/0/skills"),
    ({"stops": {2: {"skills": ["fly"]}}}, "/stops"),
    ({"vehicles": {0: {"shift": [0, 1]}}}, "/vehicles/0/shift"),
    ({"vehicles": {0: {"max_stops": 3}}}, "/vehicles/0/max_stops"),
    ({"vehicles": {1: {"breaks": [{"window": [2, 1], "length": 1}]}}}, "/vehicles/1/breaks/0"),
    ({"vehicles": {1: {"max_trips": 3}}}, "/vehicles/1/max_trips"),
    ({"vehicles": {1: {"reload": ["nowhere"]}}}, "/vehicles/1/reload/0"),
    ({"vehicles": {1: {"initial_load": [7]}}}, "/vehicles/1/initial_load/0"),
    ({"shipments": [{"pickup": "order-6", "delivery": "order-7"}]}, "/vehicles/0/reload"),
    ({"objectives": {1: {"over": "max"}}}, "/objectives/1"),
    ({"objectives": {1: {"measure": "joy"}}}, "/objectives/1/measure"),
]


@pytest.mark.parametrize(("change", "pointer"), REFUSED)
def test_a_bound_that_cannot_be_met_is_refused_where_it_stands(
    client: httpx.Client, change: dict[str, Any], pointer: str | None
) -> None:
    asked = request()
    for name, value in change.items():
        if isinstance(value, dict) and name != "clock":
            for index, members in value.items():
                asked[name][index].update(members)
        elif name == "objectives":
            asked["objectives"] = request(None)["objectives"]
            asked["clock"] = request()["clock"]
            pointer = "/clock"
        else:
            asked[name] = value
    response = client.post("/fleet", json=asked)
    assert response.status_code == 422
    pointers = [error["pointer"] for error in response.json()["errors"]]
    assert any(each.startswith(str(pointer)) for each in pointers), response.text


@pytest.mark.parametrize("further", [[], [{"name": "vans", "measure": "vehicles"}]])
def test_an_objective_beside_the_clock_counts_no_service(
    client: httpx.Client, further: list[dict[str, Any]]
) -> None:
    costs = {"from": "great_circle", "speed": 30, "unit": "s"}
    objectives = [{**costs, "name": "driving"}, {**costs, "name": "longest", "over": "max"}]
    asked = request(objectives=[*objectives, *further], clock="longest")
    answer = client.post("/fleet", json=asked).json()
    for plan in answer["front"]:
        lost = plan["measures"]["unassigned"]
        assert plan["lengths"][0] == pytest.approx(plan["measures"]["driving"] + lost)
        assert plan["lengths"][1] == pytest.approx(plan["measures"]["longest"])
        assert plan["measures"]["service"] > 0
