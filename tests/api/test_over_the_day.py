"""Fronts over the day, over HTTP."""

from itertools import pairwise
from typing import Any

import httpx
import pytest

from tests.helpers.serving import problem

HOUR = 3600.0
PEAK = [[0, 1.0], [7 * HOUR, 2.0], [9 * HOUR, 1.0]]
TIMES = [[0, 1800, 3600, 900], [1800, 0, 900, 3600], [3600, 900, 0, 1800], [900, 3600, 1800, 0]]
RISK = [[0, 5, 1, 2], [5, 0, 2, 9], [1, 2, 0, 3], [2, 9, 3, 0]]


def stops(**more: Any) -> dict[str, Any]:
    """Return a request with one hour of rush, from 7 to 9 o'clock."""
    return {
        "stops": [{"id": "depot"}, *({"id": each, "service": 60} for each in "abc")],
        "objectives": [
            {"name": "time", "unit": "s", "matrix": TIMES, "over_the_day": PEAK},
            {"name": "risk", "matrix": RISK},
        ],
        "departure": 6 * HOUR,
        "time_limit": 0.1,
        **more,
    }


def sliced(**more: Any) -> dict[str, Any]:
    doubled = [[2 * cost for cost in row] for row in TIMES]
    slices = [
        {"from": begins, "matrix": matrix}
        for begins, matrix in ((0, TIMES), (7 * HOUR, doubled), (9 * HOUR, TIMES))
    ]
    request = stops(**more)
    request["objectives"][0] = {"name": "time", "unit": "s", "slices": slices}
    return request


def by_breakpoints(**more: Any) -> dict[str, Any]:
    """Return the request whose times rise from 7 o'clock on, until at 8 they are doubled."""
    of_pairs = [
        [[[7 * HOUR, cost], [8 * HOUR, 2 * cost]] if cost else None for cost in row]
        for row in TIMES
    ]
    request = stops(**more)
    request["objectives"][0] = {"name": "time", "unit": "s", "breakpoints": of_pairs}
    return request


def refused(answer: httpx.Response, pointer: str) -> None:
    [error] = problem(answer, 422, "invalid-request")["errors"]
    assert error["pointer"] == pointer


def front_of(client: httpx.Client, request: dict[str, Any]) -> dict[str, Any]:
    answer = client.post("/front", json=request)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def test_lengths_and_times_are_those_of_the_rush_hour(client: httpx.Client) -> None:
    front = front_of(client, stops())
    best = front["front"][0]
    # Either way round: the first tour leaves b at 6:47, and drives 13 minutes of 30 to c before 7.
    times = {
        "depot a b c": [0, 1800, 2760, 5640, 7500],
        "depot c b a": [0, 900, 2760, 3840, 7500],
    }
    assert best["departure"] == 6 * HOUR
    expected = times[" ".join(best["stops"])]
    assert best["times"] == [6 * HOUR + seconds for seconds in expected]
    assert best["lengths"] == [7500, 12]
    assert front["terminated"] == "converged"


def test_slices_are_as_the_factors_that_they_came_from(client: httpx.Client) -> None:
    # Not closed, as a tour and the same one turned round have the same lengths and other times.
    way = {"closed": False, "end": "b"}
    first, second = (front_of(client, each)["front"] for each in (stops(**way), sliced(**way)))
    assert [tour["times"] for tour in first] == [tour["times"] for tour in second]


def test_of_a_range_the_tour_leaves_before_the_rush(client: httpx.Client) -> None:
    ranged = {"earliest": 5 * HOUR, "latest": 8 * HOUR}
    fixed = front_of(client, stops(departure=8 * HOUR))["front"]
    best = front_of(client, stops(departure=ranged))["front"]
    assert best[0]["departure"] == 5 * HOUR
    assert best[0]["lengths"][0] < fixed[0]["lengths"][0]


def test_arrivals_are_all_lengths_up_to_each_stop(client: httpx.Client) -> None:
    for tour in front_of(client, stops(arrivals=True))["front"]:
        assert len(tour["arrivals"]) == len(tour["times"]) == 5
        assert tour["arrivals"][-1] == tour["lengths"]
        for (seconds, _), time in zip(tour["arrivals"], tour["times"], strict=True):
            assert time == tour["departure"] + seconds


def test_the_rest_is_replanned_from_now(client: httpx.Client) -> None:
    front = front_of(client, stops())
    path = f"/front/{front['id']}/replan"
    changes = {"done": ["depot", "c"], "now": 7 * HOUR, "time_limit": 0.1}
    answer = client.post(path, json=changes)
    assert answer.status_code == 200, answer.text
    best = answer.json()["front"][0]
    assert best["stops"][0] == "c"
    assert best["departure"] == best["times"][0] == 7 * HOUR
    # From c to b and on to a at half the speed, with a minute at each, and the way back.
    assert sorted(best["stops"]) == ["a", "b", "c", "depot"]
    refused(client.post(path, json={"done": ["c"]}), "/now")
    new = {"id": "new", "service": 30, "costs": [{"to": [60] * 5}, {"to": [1] * 5}]}
    added = client.post(path, json={**changes, "add": [new]})
    assert added.status_code == 200, added.text
    cost = {"objective": "time", "from": "c", "to": "b", "cost": 10}
    cheaper = client.post(path, json={**changes, "costs": [cost]}).json()["front"][0]
    assert cheaper["lengths"][0] < best["lengths"][0]


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"departure": None}, "/departure"),
        ({"departure": 1e9}, "/departure"),
        ({"departure": "07:00"}, "/departure"),
        ({"departure": {"earliest": 9, "latest": 8}}, "/departure/latest"),
        ({"clock": "risk"}, None),
        ({"clock": "ris"}, "/clock"),
        ({"bound": True}, "/bound"),
        ({"over_the_day": [[0, 1], [0, 2]]}, "/objectives/0/over_the_day/1/0"),
        ({"over_the_day": [[0, 0]]}, "/objectives/0/over_the_day/0/1"),
        ({"over_the_day": [[0, 1, 2]]}, "/objectives/0/over_the_day/0"),
        ({"over_the_day": [[-1, 1]]}, "/objectives/0/over_the_day/0/0"),
        ({"over_the_day": [[9e5, 1]]}, "/objectives/0/over_the_day/0/0"),
        ({"over_the_day": [[0, 1e300]]}, "/objectives/0/over_the_day/0/1"),
        ({"over_the_day": [[k, 1] for k in range(101)]}, "/objectives/0/over_the_day"),
        ({"unit": "min"}, "/objectives/0/unit"),
        ({"slices": [{"from": 0, "matrix": TIMES}]}, "/objectives/0"),
    ],
)
def test_what_is_no_day_is_refused(
    client: httpx.Client, change: dict[str, Any], pointer: str | None
) -> None:
    request = stops()
    for name, value in change.items():
        of_objective = name in ("over_the_day", "unit", "slices")
        (request["objectives"][0] if of_objective else request)[name] = value
    answer = client.post("/front", json=request)
    if pointer is None:
        assert answer.status_code == 200, answer.text
    else:
        refused(answer, pointer)


def test_slices_are_checked_like_matrices(client: httpx.Client) -> None:
    request = sliced()
    request["objectives"][0]["slices"][1]["matrix"] = TIMES[:3]
    answer = client.post("/front", json=request)
    refused(answer, "/objectives/0/slices/1/matrix")
    request = sliced()
    request["objectives"][0]["slices"][2]["from"] = 1
    answer = client.post("/front", json=request)
    refused(answer, "/objectives/0/slices/2/from")


def test_by_breakpoints_a_leg_takes_what_lies_between_them(client: httpx.Client) -> None:
    best = front_of(client, by_breakpoints(departure=6.5 * HOUR))["front"][0]
    time, reached = 6.5 * HOUR, []
    order = [*best["tour"], 0]
    for before, stop in zip([None, *order], order, strict=False):
        if before is not None:
            time += TIMES[before][stop] * (1 + min(1.0, max(0.0, time / HOUR - 7)))
        reached.append(time)
        time += 60 if stop else 0
    assert best["times"] == pytest.approx(reached)
    assert best["lengths"][0] == pytest.approx(reached[-1] - 6.5 * HOUR)


@pytest.mark.parametrize(
    ("where", "given", "pointer"),
    [
        ((), [[None]], ""),
        ((1,), [None], "/1"),
        ((1, 0), [], "/1/0"),
        ((1, 0), [[0, 1]] * 2, "/1/0/1/0"),
        ((1, 0), [[60, 1], [30, 1]], "/1/0/1/0"),
        ((1, 0), [[0, 100], [30, 69]], "/1/0/1/1"),
        ((1, 0), [[0, 1, 2]], "/1/0/0"),
        ((1, 0), [[-1, 1]], "/1/0/0/0"),
        ((1, 0), [[9e5, 1]], "/1/0/0/0"),
        ((1, 0), [[0, None]], "/1/0/0/1"),
        ((1, 0), [[k, 1] for k in range(1001)], "/1/0"),
    ],
)
def test_what_are_no_breakpoints_is_refused(
    client: httpx.Client, where: tuple[int, ...], given: Any, pointer: str
) -> None:
    request = by_breakpoints()
    if not where:
        request["objectives"][0]["breakpoints"] = given
    else:
        rows: Any = request["objectives"][0]["breakpoints"]
        for index in where[:-1]:
            rows = rows[index]
        rows[where[-1]] = given
    answer = client.post("/front", json=request)
    refused(answer, f"/objectives/0/breakpoints{pointer}")


def test_a_pair_without_breakpoints_is_never_driven(client: httpx.Client) -> None:
    request = by_breakpoints()
    request["objectives"][0]["breakpoints"][0][3] = None
    found = front_of(client, request)
    assert all(tour["stops"][1] != "c" for tour in found["front"])
    rest = {
        "done": ["depot"],
        "now": 6 * HOUR,
        "costs": [{"objective": "time", "from": "depot", "to": "a", "cost": None}],
    }
    answer = client.post(f"/front/{found['id']}/replan", json=rest)
    assert answer.status_code == 200, answer.text
    assert all(tour["stops"][1] == "b" for tour in answer.json()["front"])
    request["objectives"][0]["breakpoints"] = [[None] * 4] * 4
    answer = client.post("/front", json=request)
    assert answer.status_code == 422


def test_fleets_are_driven_by_breakpoints_and_no_vehicle_slower_than_these(
    client: httpx.Client,
) -> None:
    request = by_breakpoints()
    fleet = {
        "stops": request["stops"],
        "vehicles": [
            {
                "id": "van",
                "count": 2,
                "start": "depot",
                "end": "depot",
                "shift": [7.5 * HOUR, 12 * HOUR],
            }
        ],
        "objectives": [request["objectives"][0], {"name": "vans", "measure": "vehicles"}],
        "clock": "time",
        "time_limit": 0.2,
    }
    answer = client.post("/fleet", json=fleet)
    assert answer.status_code == 200, answer.text
    for plan in answer.json()["front"]:
        for route in plan["routes"]:
            path = [0, *(["depot", *"abc"].index(stop) for stop in route["stops"]), 0]
            time = route["arrivals"][0]
            for before, stop in pairwise(path):
                time += TIMES[before][stop] * (1 + min(1.0, max(0.0, time / HOUR - 7)))
                time += 60 if stop else 0
            assert route["arrivals"][-1] == pytest.approx(time)
    fleet["vehicles"][0]["speed_factor"] = 0.9  # type: ignore[index]
    refused(client.post("/fleet", json=fleet), "/vehicles/0/speed_factor")


def test_fleets_have_plans_of_a_network_alone_at_true_times(client: httpx.Client) -> None:
    places = [[i * i % 11, i * 7 % 13] for i in range(13)]
    seconds = [[300 * (abs(a - c) + abs(b - d)) for c, d in places] for a, b in places]
    visits = [{"id": f"{i}", "window": [6 * HOUR, 11 * HOUR]} for i in range(1, len(places))]
    fleet = {
        "stops": [{"id": "0"}, *visits],
        "vehicles": [
            {"id": "van", "count": 9, "start": "0", "end": "0", "shift": [6 * HOUR, 14 * HOUR]}
        ],
        "objectives": [
            {"name": "time", "matrix": seconds, "over_the_day": [[0, 1], [9 * HOUR, 3]]},
            {"name": "vans", "measure": "vehicles"},
        ],
        "clock": "time",
        "time_limit": 0,
    }
    answer = client.post("/fleet", json=fleet)
    assert answer.status_code == 200, answer.text
    for plan in answer.json()["front"]:
        assert sorted(stop for each in plan["routes"] for stop in each["stops"][1:-1]) == sorted(
            each["id"] for each in visits
        )
        total = 0.0
        for route in plan["routes"]:
            arrivals = route["arrivals"]
            for leg, (leaves, arrives) in zip(
                pairwise(map(int, route["stops"])), pairwise(arrivals), strict=True
            ):
                # Before 9 a second brings the vehicle on by one second of the way, then by a third.
                early = max(0.0, min(arrives, 9 * HOUR) - leaves)
                late = arrives - leaves - early
                assert early + late / 3 == pytest.approx(seconds[leg[0]][leg[1]])
            assert all(time <= 11 * HOUR for time in arrivals[1:-1])
            total += arrivals[-1] - arrivals[0]
        assert plan["lengths"] == pytest.approx([total, len(plan["routes"])])


def test_a_leg_that_one_slice_forbids_is_never_driven(client: httpx.Client) -> None:
    request = sliced()
    closed = [list(row) for row in TIMES]
    closed[0][3] = None  # type: ignore[call-overload]
    request["objectives"][0]["slices"][2]["matrix"] = closed
    for tour in front_of(client, request)["front"]:
        assert tour["stops"][1] != "c"


def test_cities_without_names_and_fronts_without_a_day_refuse_it(client: httpx.Client) -> None:
    cities = {"coordinates": [[0, 0, 1, 1], [1, 2, 3, 4], [5, 5, 0, 1]]}
    answer = client.post("/front", json={**cities, "departure": 0})
    refused(answer, "/departure")
    front = client.post("/front", json=cities).json()["id"]
    answer = client.post(f"/front/{front}/replan", json={"now": 5, "done": [0]})
    refused(answer, "/now")


def test_service_alone_needs_a_departure(client: httpx.Client) -> None:
    request = stops()
    del request["departure"]
    del request["objectives"][0]["over_the_day"]
    refused(client.post("/front", json=request), "/departure")
    request["departure"] = 0
    front = front_of(client, request)["front"]
    assert front[0]["lengths"][0] == 900 + 1800 + 900 + 1800 + 180
