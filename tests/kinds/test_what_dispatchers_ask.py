"""Requests for fleets that dispatchers asked for in public, each by the thread that asks."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from service.errors import Refusal
from service.kinds.fleet import run_fleet
from service.kinds.kind import Tools
from service.kinds.parsing import parse_replan, parse_task
from service.requests.replan.way import ReplanSource, StoredFront
from service.requests.task import TaskSource
from service.requests.task_codec import encode_task
from service.watch import Watch
from tests.helpers.fleet_requests import LIMITS

Json = dict[str, Any]
# Places on a line: the depot is at 0, and a unit of way takes a unit of time.
WEST, NEAR, EAST, FAR = -10, 1, 10, 20


def fleet(stops: dict[str, Json], vans: int = 1, **members: Any) -> Json:
    """Return a request of stops at `at` on a line, and vans that start and end at 0."""
    at = [0, *(stop["at"] for stop in stops.values())]
    costs = [[abs(a - b) for b in at] for a in at]
    named = [
        {"id": name, **{key: value for key, value in stop.items() if key != "at"}}
        for name, stop in stops.items()
    ]
    van = {"id": "van", "count": vans, "start": "depot", "end": "depot", **members.pop("van", {})}
    against = members.pop("against", {"over": "max"})
    costly = {} if "measure" in against else {"matrix": costs}
    return {
        "stops": [{"id": "depot"}, *named],
        "vehicles": [van],
        "objectives": [{"name": "time", "matrix": costs}, {"name": "other", **costly, **against}],
        "clock": "time",
        "time_limit": 0.2,
        **members,
    }


def front_of(request: Json) -> list[Json]:
    """Return the plans of a front, by ascending first length."""
    limits = replace(LIMITS, seconds=30.0)
    # All plans of so few stops are tried, in far less time.
    patient = {**request, "time_limit": request["time_limit"] and limits.seconds}
    task = parse_task(TaskSource("fleet", json.dumps(patient).encode()), limits, {})
    document = run_fleet(task.subject, task, Tools({}, limits), Watch())
    front: list[Json] = json.loads(document.json(id="", status="done"))["front"]
    return front


def planned(request: Json) -> Json:
    """Return the plan of a front with the least first length."""
    return front_of(request)[0]


def routes(plan: Json) -> list[set[str]]:
    return sorted(({*route["stops"]} - {"depot"} for route in plan["routes"]), key=sorted)


SIDES = {"west": {"at": WEST}, "east": {"at": EAST}}
ROUTES = {
    # A driver takes the delivery in the north or the one in the south, not both.
    "vroom#1343": (
        fleet(SIDES, 2, apart=[{"stops": ["west", "east"]}]),
        [{"east"}, {"west"}],
    ),
    # Passengers of two schools do not share a vehicle; those of one school may.
    "vroom#1339": (
        fleet(
            {"a1": {"at": EAST}, "b1": {"at": EAST}, "a2": {"at": FAR}},
            2,
            apart=[{"stops": ["a1", "a2"], "others": ["b1"]}],
        ),
        [{"a1", "a2"}, {"b1"}],
    ),
    # Counterparts in two sets of places are visited by the same vehicle.
    "vroom#540": (
        fleet(
            {"1": {"at": WEST}, "1_1": {"at": EAST}, "2": {"at": FAR}},
            2,
            together=[["1", "1_1"]],
            van={"max_stops": 2},
        ),
        [{"1", "1_1"}, {"2"}],
    ),
    # No route is worth a driver for a single order.
    "at least two stops": (
        fleet({**SIDES, "far": {"at": FAR}, "near": {"at": NEAR}}, 4, van={"min_stops": 2}),
        [{"east", "far", "near", "west"}],
    ),
}


@pytest.mark.parametrize("thread", ROUTES)
def test_stops_ride_with_those_that_were_asked_for(thread: str) -> None:
    request, expected = ROUTES[thread]
    assert routes(planned(request)) == expected


URGENT = {"normal": {"at": NEAR}, "urgent": {"at": EAST}, "vip": {"at": FAR}}
ORDERS = {
    # On each route urgent stops come before normal ones; their own order is free.
    "vroom#1269": (
        fleet(URGENT, before=[{"first": ["vip", "urgent"], "then": ["normal"]}]),
        [["urgent", "vip", "normal"], ["vip", "urgent", "normal"]],
    ),
    # One stop must come before another on the same vehicle.
    "vroom#1325": (
        fleet(
            URGENT, before=[{"first": ["vip"], "then": ["urgent"]}], together=[["vip", "urgent"]]
        ),
        [["normal", "vip", "urgent"], ["vip", "urgent", "normal"]],
    ),
}


@pytest.mark.parametrize("thread", ORDERS)
def test_stops_come_in_the_order_that_was_asked_for(thread: str) -> None:
    request, shortest = ORDERS[thread]
    [route] = planned(request)["routes"]
    assert route["stops"][1:-1] in shortest


BIKE = {"id": "bike", "start": "depot", "end": "depot"}
TYPES = {
    # A vehicle of a high fixed cost and a low one for each kilometre drives the long routes alone.
    "vroom#1344, a short route": (
        {"job": {"at": NEAR}},
        {"fixed": 10},
        {"per_distance": 3},
        "bike",
    ),
    "vroom#1344, a long route": ({"job": {"at": FAR}}, {"fixed": 10}, {"per_distance": 3}, "van"),
    # Vehicles differ in their speed.
    "vroom#394": ({"job": {"at": FAR}}, {}, {"speed_factor": 0.5}, "van"),
    # A beginner takes longer for a visit, and so does who comes with a trailer.
    "vroom#336": ({"job": {"at": FAR, "service": 9}}, {"service_factor": 1.3}, {}, "bike"),
    "vroom#879": (
        {"job": {"at": FAR, "services": [{"vehicle": "bike", "service": 3}]}},
        *({"fixed": 2}, {}, "van"),
    ),
    # No route drives longer than its vehicle may.
    "vroom#918": ({"job": {"at": FAR}}, {"fixed": 5}, {"max_driving": 39}, "van"),
}


@pytest.mark.parametrize("thread", TYPES)
def test_the_vehicle_drives_that_was_asked_for(thread: str) -> None:
    stops, van, bike, expected = TYPES[thread]
    request = fleet(stops, van=van)
    request["vehicles"].append({**BIKE, **bike})
    assert [route["vehicle"] for route in planned(request)["routes"]] == [expected]


def test_a_speed_is_of_times_alone() -> None:
    """vroom#1248: it changes neither distances, nor limits on these, nor costs of their own."""
    van = {"speed_factor": 0.5, "max_distance": 40, "max_driving": 80}
    plan = planned(fleet({"job": {"at": FAR}}, van=van))
    [route] = plan["routes"]
    assert plan["lengths"] == route["lengths"] == [80, 40]
    assert (route["distance"], route["driving"]) == ([0, 20, 40], [0, 40, 80])


EMPTIES = {
    # Two stops are full of what comes back: the one that gives most is served last.
    "vroom#565": ({"demand": [1], "pickup": [4]}, {"demand": [3], "pickup": [2]}, ["east", "west"]),
    "vroom#880": ({"demand": [3], "pickup": [2]}, {"demand": [1], "pickup": [4]}, ["west", "east"]),
}


@pytest.mark.parametrize("case", EMPTIES)
def test_a_stop_takes_goods_and_gives_others_back(case: str) -> None:
    """A route starts with all that it brings, and ends with all that it takes back."""
    west, east, order = EMPTIES[case]
    stops = {"west": {"at": WEST, **west}, "east": {"at": EAST, **east}}
    [route] = planned(fleet(stops, van={"capacity": [6]}))["routes"]
    assert (route["stops"][1:3], route["load"]) == (order, [6])
    with pytest.raises(Refusal, match="the pickups sum to 6"):
        planned(fleet(stops, van={"capacity": [5]}))


def test_what_was_taken_on_stays_on_board_while_the_fleet_is_replanned() -> None:
    stops = {
        "west": {"at": WEST, "demand": [1], "pickup": [4]},
        "east": {"at": EAST, "demand": [1], "pickup": [1]},
        "far": {"at": FAR, "demand": [0], "pickup": [2], "prize": 500},
    }
    _, source = begun_with("west", fleet(stops, van={"capacity": [6]}))
    rest = parse_replan(source, LIMITS, {})
    document = run_fleet(rest.subject, rest, Tools({}, LIMITS), Watch())
    [plan, *_] = json.loads(document.json(id="", status="done"))["front"]
    assert ([each["load"] for each in plan["routes"]], plan["unassigned"]) == ([[5]], ["far"])


@pytest.mark.parametrize(
    ("members", "pointer", "code"),
    [
        ({"van": {"capacity": [6], "reload": [0]}}, "/vehicles/0/reload", "also-given"),
        ({"van": {"capacity": [6, 6]}}, "/stops/1/pickup", "not-as-capacities"),
        (
            {"van": {"capacity": [6]}, "shipments": [{"pickup": 1, "delivery": 2}]},
            *("/stops/1/pickup", "pickup-of-shipment"),
        ),
    ],
)
def test_goods_that_come_back_are_refused_where_they_cannot(
    members: Json, pointer: str, code: str
) -> None:
    with pytest.raises(Refusal) as refused:
        planned(fleet({"west": {"at": WEST, "pickup": [4]}, "east": {"at": EAST}}, **members))
    [fault] = refused.value.errors
    assert (fault.pointer, fault.code) == (pointer, code)


def by_profile(request: Json, **factors: float) -> Json:
    """Return a request whose vehicles have profiles, and matrices in which they differ."""
    for objective in request["objectives"]:
        matrix = objective.pop("matrix")
        objective["matrices"] = [
            {
                "profile": name,
                "matrix": [[cost and cost * factor for cost in row] for row in matrix],
            }
            for name, factor in factors.items()
        ]
    pairs = zip(request["vehicles"], factors, strict=True)
    return {**request, "vehicles": [{**each, "profile": name} for each, name in pairs]}


@pytest.mark.parametrize(("truck", "driver"), [(3, "van"), (0.5, "bike")])
def test_vehicles_drive_by_matrices_of_their_own(truck: float, driver: str) -> None:
    """vroom#654: each vehicle has costs of its own; vroom#468: a motorbike and a car."""
    request = fleet(SIDES)
    request["vehicles"].append(BIKE)
    request = by_profile(request, car=1, truck=truck)
    plan = planned(request)
    assert [(route["vehicle"], route["profile"]) for route in plan["routes"]] == [
        (driver, {"van": "car", "bike": "truck"}[driver])
    ]
    assert plan["lengths"][0] == 40 * min(1, truck)
    _, source = begun_with("west", request)
    rest = parse_replan(source, LIMITS, {})
    document = run_fleet(rest.subject, rest, Tools({}, LIMITS), Watch())
    [after, *_] = json.loads(document.json(id="", status="done"))["front"]
    assert [route["vehicle"] for route in after["routes"]] == [driver]
    assert after["routes"][0]["arrivals"][-1] == 30 + 30 * min(1, truck)
    body = json.dumps({**json.loads(source.body), "add": [{"id": "new"}]}).encode()
    with pytest.raises(Refusal, match='add/0 cannot be added, as the costs of "time"'):
        parse_replan(replace(source, body=body), LIMITS, {})


def test_a_dear_vehicle_stays_where_one_under_way_can_serve() -> None:
    """vroom#1344: order B may ride with who has A on board, and costs a thousandth there."""
    stops = {"A": {"at": FAR, "skills": ["special"]}, "B": {"at": EAST}}
    request = fleet(stops, van={"skills": ["special"], "per_distance": 2})
    request["vehicles"].append({**BIKE, "per_distance": 2000})
    plan = planned(request)
    assert [each["vehicle"] for each in plan["routes"]] == ["van"]
    assert plan["lengths"][0] == 2 * 2 * FAR


VANS = [{"id": "a"}, {"id": "b"}]
PROFILED = by_profile({**fleet(SIDES), "vehicles": VANS}, car=1, truck=2)
WRONG_PROFILES = [
    ("vehicles/1/profile", None, "profile-needed"),
    ("vehicles/1/profile", "trick", "not-a-profile"),
    ("objectives/0/matrices/1/profile", "car", "not-unique"),
    ("objectives/0/matrices/1/matrix", [[0]], "row-each"),
    ("objectives/0/matrix", [[0] * 3] * 3, "not-one-source"),
]


@pytest.mark.parametrize(("path", "value", "code"), WRONG_PROFILES)
def test_a_profile_without_costs_is_refused(path: str, value: Any, code: str) -> None:
    request = json.loads(json.dumps(PROFILED))
    *parts, last = path.split("/")
    place = request
    for part in parts:
        place = place[int(part) if part.isdecimal() else part]
    place[last] = value
    with pytest.raises(Refusal) as refused:
        planned(request)
    [fault] = refused.value.errors
    assert fault.code == code
    assert fault.pointer == {"not-one-source": "/objectives/0"}.get(code, f"/{path}")


@pytest.mark.parametrize(
    ("objective", "known", "code"),
    [
        ({"from": "great_circle"}, ("car",), "profile-of-nothing"),
        ({"from": "road_time"}, ("car",), "not-a-road-profile"),
        ({"from": "road_time"}, (), "no-road-profiles"),
    ],
)
def test_a_profile_that_says_nothing_is_refused(
    objective: Json, known: tuple[str, ...], code: str
) -> None:
    place = {"id": "depot", "location": [24.9, 60.1]}
    request = {
        "stops": [place, {**place, "id": "job"}],
        "vehicles": [{"id": "lorry", "profile": "truck"}],
        "objectives": [{"name": "a", **objective}, {"name": "b", **objective, "over": "max"}],
    }
    limits = replace(LIMITS, roads=True, profiles=known)
    with pytest.raises(Refusal) as refused:
        parse_task(TaskSource("fleet", json.dumps(request).encode()), limits, {})
    [fault] = refused.value.errors
    assert (fault.code, fault.pointer) == (code, "/vehicles/0/profile")


def test_a_vehicle_leaves_early_and_waits_at_the_stops() -> None:
    """vroom#1019: vehicles start at a given time and are at each stop as soon as they can."""
    stops = {"job": {"at": EAST, "window": [60, 480]}}
    late = planned(fleet(stops, van={"shift": [0, 480]}))
    early = planned(fleet(stops, van={"shift": [0, 480]}, leave="early"))
    assert late["routes"][0]["arrivals"] == [50, 60, 70]
    assert early["routes"][0]["arrivals"] == [0, 10, 70]
    assert (late["lengths"][0], early["lengths"][0]) == (20, 70)


def test_a_vehicle_is_at_an_appointment_with_time_in_hand() -> None:
    stops = {"appointment": {"at": EAST, "window": [60, 60]}}
    for slack, arrival in ((0, 60), (8, 52)):
        plan = planned(fleet(stops, slack=slack))
        assert plan["routes"][0]["arrivals"] == [arrival - 10, arrival, 70]


def test_early_visits_count_as_late_ones_do() -> None:
    """PyVRP#631: a few minutes early or late are not desirable, but are possible."""
    stops = {"near": {"at": NEAR, "due": [15, 30]}, "far": {"at": FAR}}
    early = {"against": {"measure": "earliness"}}
    plan = planned(fleet(stops, van={"shift": [0, 480]}, leave="early", **early))
    assert plan["measures"]["earliness"] == plan["lengths"][1] == 0
    assert plan["routes"][0]["stops"] == ["depot", "far", "near", "depot"]


def test_the_urgent_are_visited_early() -> None:
    """vroom#1120: the most urgent tasks first, and the less urgent ones then."""
    stops = {"normal": {"at": WEST}, "urgent": {"at": EAST, "urgency": 50}}
    weighed = fleet(stops, against={"measure": "weighted_arrival"})
    plan = planned(weighed)
    assert plan["routes"][0]["stops"][1:3] == ["urgent", "normal"]
    assert plan["measures"]["weighted_arrival"] == 50 * 10 + 30


def test_who_must_be_early_is_first_where_times_spread_also_while_it_is_replanned() -> None:
    """OpenTripPlanner#6874: what half of all days take, and nine of ten; here with windows too."""
    stops = {"west": {"at": WEST, "window": [0, 100]}, "east": {"at": EAST, "window": [0, 32]}}
    request = fleet(stops, leave="early", against={"measure": "on_time"})
    request["objectives"][0] |= {"spread": 0.2, "percentile": 90}
    [plan] = front_of(request)
    assert plan["routes"][0]["stops"][1:3] == ["east", "west"]
    most, late = plan["lengths"]
    assert most == plan["measures"]["duration_p90"] > plan["measures"]["duration"] == 40
    assert 1e-3 > late == pytest.approx(2 * (1 - plan["measures"]["on_time"]))
    _, source = begun_with("east", request)
    rest = parse_replan(source, LIMITS, {})
    document = run_fleet(rest.subject, rest, Tools({}, LIMITS), Watch())
    [plan, *_] = json.loads(document.json(id="", status="done"))["front"]
    assert plan["lengths"][0] == plan["measures"]["duration_p90"]


DAYS = (0.5, 1, 1, 1.5)  # how slow all roads are on each of four days


def test_the_days_that_are_given_stay_while_a_fleet_is_replanned() -> None:
    """vroom#1280 on days that differ: on the slow one the stop in the east is missed."""
    stops = {"west": {"at": WEST, "window": [0, 100]}, "east": {"at": EAST, "window": [0, 14]}}
    request = fleet(stops, leave="early", against={"measure": "on_time"})
    time = request["objectives"][0]
    costs = np.array(time.pop("matrix"))
    time["days"] = [{"matrix": (slow * costs).tolist()} for slow in DAYS]
    [plan] = front_of(request)
    assert plan["routes"][0]["stops"][1:3] == ["east", "west"]
    assert plan["lengths"] == [40, 0.25]
    assert plan["measures"]["on_time"] == 1 - 0.25 / 2
    assert (plan["measures"]["duration"], plan["measures"]["duration_p90"]) == (40, 60)
    _, source = begun_with("east", request)
    # A leg that has changed is the same on all days, and so are those of a new stop, in the east.
    changes = json.loads(source.body)
    changes["costs"] = [{"objective": "time", "from": "west", "to": "depot", "cost": 12}]
    new = {"id": "new", "costs": [{"to": [10, 20, 0, 0], "from": [10, 20, 0, 0]}]}
    for added, most in ([], 1.5 * 20 + 12), ([new], 20 + 12):
        body = json.dumps({**changes, "add": added}).encode()
        rest = parse_replan(replace(source, body=body), LIMITS, {})
        document = run_fleet(rest.subject, rest, Tools({}, LIMITS), Watch())
        [after, *_] = json.loads(document.json(id="", status="done"))["front"]
        assert after["measures"]["duration_p90"] == most


def begun_with(stop: str, request: Json, **way: Any) -> tuple[int, ReplanSource]:
    """Return the number of a route that has visited a stop, and a request to replan the rest.

    `way` are more members of the route on its way.
    """
    task = parse_task(TaskSource("fleet", json.dumps(request).encode()), LIMITS, {})
    front = run_fleet(task.subject, task, Tools({}, LIMITS), Watch())
    plan = json.loads(front.json(id="", status="done"))["front"][0]
    begun = next(i for i, route in enumerate(plan["routes"]) if stop in route["stops"])
    changes = {"plan": 0, "now": 30, "routes": [{"route": begun, "done": [stop], **way}]}
    stored = StoredFront("", encode_task(task), front)
    return begun, ReplanSource(json.dumps(changes).encode(), stored)


# Driven west by 10 of the 40 there and back, there are 30 more. The plan does not say how far it is
# to a place between two stops.
HERE: Json = {"id": "here", "costs": [{"to": [5, 5, 15, 0]}] * 2}
UNDER_WAY = [
    ({"max_driving": 40}, {}, True),
    ({"max_driving": 45}, {"driving": 15}, True),
    ({"max_driving": 40}, {"driving": 11}, False),
    ({"max_distance": 40}, {}, True),
    ({"max_distance": 40}, {"distance": 10.5}, False),
    ({"max_driving": 40}, {"position": HERE, "driving": 15}, True),
    ({"max_driving": 40}, {"position": HERE, "driving": 16}, False),
    ({"max_driving": 40, "max_distance": 40}, {"position": HERE, "driving": 15}, None),
]


@pytest.mark.parametrize(("limits", "way", "has_plan"), UNDER_WAY)
def test_what_was_driven_counts_while_the_fleet_is_replanned(
    limits: Json, way: Json, has_plan: bool | None
) -> None:
    """vroom#918: what a driver may drive is of the whole day."""
    _, source = begun_with("west", fleet(SIDES, van=limits), **way)
    if has_plan is None:
        with pytest.raises(Refusal) as refused:
            parse_replan(source, LIMITS, {})
        [fault] = refused.value.errors
        assert (fault.pointer, fault.code) == ("/routes/0/distance", "not-driven")
        return
    rest = parse_replan(source, LIMITS, {})
    if not has_plan:
        with pytest.raises(Refusal):
            run_fleet(rest.subject, rest, Tools({}, LIMITS), Watch())
        return
    document = run_fleet(rest.subject, rest, Tools({}, LIMITS), Watch())
    [plan, *_] = json.loads(document.json(id="", status="done"))["front"]
    [route] = plan["routes"]
    from_there = [0, 15, 25] if "position" in way else [0, 20, 30]
    for name in limits:
        assert route[name.removeprefix("max_")] == from_there


STREETS = {  # stops a, b, ... from west to east on both sides of the depot
    name: {"at": at} for name, at in zip("abde", (-12, -11, 11, 12), strict=True)
}
COMPACT = {
    # Stops of a vehicle form a cluster, even if that is a little longer.
    "vroom#1288": fleet(STREETS, 2, van={"max_stops": 2}, against={"measure": "overlap"}),
    # Points close to each other belong on one path.
    "vroom#1066": fleet(STREETS, 3, van={"max_stops": 2}, against={"measure": "overlap"}),
    # Each vehicle has an area of its own; next-door orders share a vehicle, within its hours.
    "vrp#171": fleet(
        {name: {**stop, "window": [0, 90]} for name, stop in STREETS.items()},
        2,
        van={"shift": [0, 100], "max_stops": 2},
        against={"measure": "overlap"},
    ),
    # Vehicles spread over the area, in place of several at the same locations.
    "PyVRP#822": fleet(
        {name: {**stop, "demand": [1]} for name, stop in STREETS.items()},
        2,
        van={"capacity": [2]},
        against={"measure": "overlap"},
    ),
}


@pytest.mark.parametrize("thread", COMPACT)
def test_the_least_overlap_is_among_the_plans(thread: str) -> None:
    last = front_of(COMPACT[thread])[-1]
    assert routes(last) == [{"a", "b"}, {"d", "e"}]
    assert 0 < last["measures"]["overlap"] == last["lengths"][1] < 0.5


def test_a_promised_plan_is_kept_or_changed_for_a_shorter_one() -> None:
    """vroom#1324: planned again with one order more, and as little else changes as can be."""
    promised = {
        "routes": [
            {
                "vehicle": "van",
                "stops": ["depot", "west", "east", "depot"],
                "arrivals": [0, 10, 30, 40],
            },
            {"vehicle": "van", "stops": ["near", "far"], "arrivals": [1, 20]},
        ],
        "tolerance": 2,
    }
    stops = {"west": {"at": WEST}, "east": {"at": EAST}, "near": {"at": NEAR}, "far": {"at": FAR}}
    added = {**stops, "new": {"at": FAR + 1}}
    request = fleet(added, 2, promised=promised, against={"measure": "changes"})
    plans = front_of(request)
    kept = plans[-1]
    assert kept["measures"]["changes"] == kept["lengths"][1] == 0
    # "new" may come before "far" or after it: neither is longer, nor late.
    assert routes(kept) == [{"west", "east"}, {"near", "far", "new"}]
    shortest = plans[0]
    assert shortest["lengths"][0] < kept["lengths"][0]
    assert shortest["lengths"][1] > 0


@pytest.mark.parametrize(("tolerance", "changed"), [(None, 0), (20, 0), (15, 1)])
def test_a_later_visit_is_a_change_beyond_the_tolerance(
    tolerance: float | None, changed: int
) -> None:
    """The new stop in the west comes first, as it closes early: the east is visited 20 later."""
    route = {"vehicle": "van", "stops": ["east"], "arrivals": [EAST]}
    promised = {"routes": [route], "tolerance": tolerance}
    stops = {"east": {"at": EAST}, "west": {"at": WEST, "window": [0, 12]}}
    request = fleet(
        stops, promised=promised, van={"shift": [0, 99]}, against={"measure": "changes"}
    )
    [plan] = front_of(request)
    assert plan["measures"]["changes"] == changed


def test_a_replanned_fleet_trades_length_against_changes() -> None:
    """vroom#800: orders fall out during the day, and the plan should not be turned over."""
    stops = {name: {"at": at} for name, at in zip("abcde", (-12, -11, 3, 11, 12), strict=True)}
    request = fleet(stops, 2, van={"max_stops": 3, "shift": [0, 200], "fixed": 9})
    task = parse_task(TaskSource("fleet", json.dumps(request).encode()), LIMITS, {})
    front = run_fleet(task.subject, task, Tools({}, LIMITS), Watch())
    plans = json.loads(front.json(id="", status="done"))["front"]
    number = next(i for i, plan in enumerate(plans) if len(plan["routes"]) == 2)
    changes = {
        "plan": number,
        "now": 0,
        "remove": ["d", "e"],
        "changes": {"name": "changed", "tolerance": 1},
    }
    source = ReplanSource(json.dumps(changes).encode(), StoredFront("", encode_task(task), front))
    rest = parse_replan(source, LIMITS, {})
    document = run_fleet(rest.subject, rest, Tools({}, LIMITS), Watch())
    answer = json.loads(document.json(id="", status="done"))
    assert answer["objectives"][2]["measure"] == "changes"
    before = {
        stop: (i, arrival)
        for i, route in enumerate(plans[number]["routes"])
        for stop, arrival in zip(route["stops"], route["arrivals"], strict=True)
    }
    for plan in answer["front"]:
        changed = sum(
            route.get("route") != before[stop][0] or arrival > before[stop][1] + 1
            for route in plan["routes"]
            for stop, arrival in zip(route["stops"], route["arrivals"], strict=True)
            if stop != "depot"
        )
        assert plan["lengths"][2] == plan["measures"]["changes"] == changed
    counts = {plan["lengths"][2] for plan in answer["front"]}
    assert min(counts) == 0 < max(counts)


def test_what_a_vehicle_has_visited_counts_while_the_fleet_is_replanned() -> None:
    """vroom#800: the day goes on, and the rest keeps what was asked for."""
    stops = {"west": {"at": WEST}, "east": {"at": EAST}, "far": {"at": FAR}}
    groups = {"together": [["west", "far"]], "apart": [{"stops": ["east", "west"]}]}
    begun, source = begun_with("west", fleet(stops, 2, **groups))
    rest = parse_replan(source, LIMITS, {})
    [after, *_] = json.loads(
        run_fleet(rest.subject, rest, Tools({}, LIMITS), Watch()).json(id="", status="done")
    )["front"]
    assert {route.get("route"): route["stops"][1:-1] for route in after["routes"]} == {
        begun: ["far"],
        None: ["east"],
    }


CREWS = {
    "wires": {"at": EAST, "service": 30, "skills": ["wires"]},
    "paint": {"at": EAST, "vehicle": "van"},
}


def with_crews(**wait: Any) -> Json:
    """Return a request of an electrician and a painter, who are wanted at the same house."""
    request = fleet(CREWS, before=[{"first": ["wires"], "then": ["paint"], **wait}])
    electrician = {**request["vehicles"][0], "id": "electrician", "skills": ["wires"]}
    return {**request, "vehicles": [*request["vehicles"], electrician]}


@pytest.mark.parametrize(
    ("wait", "end"),
    # On one route alone the order counts; then the wires must be done, or the plaster dry.
    [({}, 10), ({"vehicles": "any"}, 40), ({"vehicles": "any", "gap": 50}, 90)],
)
def test_a_vehicle_waits_until_another_is_done(wait: Json, end: float) -> None:
    plan = planned(with_crews(**wait))
    ends = {
        stop: end for r in plan["routes"] for stop, end in zip(r["stops"], r["ends"], strict=True)
    }
    assert (ends["wires"], ends["paint"]) == (40, end)
    assert plan["measures"]["waiting"] == 0  # the painter leaves later instead


@pytest.mark.parametrize(("done", "begins"), [([], 100), (["wires"], 90)])
def test_a_gap_counts_from_a_visit_that_is_done(done: list[str], begins: float) -> None:
    request = with_crews(vehicles="any", gap=50)
    task = parse_task(TaskSource("fleet", json.dumps(request).encode()), LIMITS, {})
    front = run_fleet(task.subject, task, Tools({}, LIMITS), Watch())
    [*plans] = json.loads(front.json(id="", status="done"))["front"]
    begun = next(i for i, r in enumerate(plans[0]["routes"]) if r["vehicle"] == "electrician")
    routes = [{"route": begun, "done": done}] if done else []
    changes = {"plan": 0, "now": 45 if done else 10, "routes": routes}
    source = ReplanSource(json.dumps(changes).encode(), StoredFront("", encode_task(task), front))
    rest = parse_replan(source, LIMITS, {})
    document = run_fleet(rest.subject, rest, Tools({}, LIMITS), Watch())
    [plan, *_] = json.loads(document.json(id="", status="done"))["front"]
    ends = {
        stop: end for r in plan["routes"] for stop, end in zip(r["stops"], r["ends"], strict=True)
    }
    assert ends["paint"] == begins


def over_the_day(request: Json, **members: Any) -> Json:
    """Return a request whose travel times change over the day."""
    time, *others = request["objectives"]
    if "slices" in members:
        time = {key: value for key, value in time.items() if key != "matrix"}
    return {**request, "objectives": [{**time, **members}, *others]}


def slices(*factors: tuple[float, float]) -> list[Json]:
    """Return the costs of a depot and a stop 10 away, with a factor from some time on each."""
    return [{"from": begin, "matrix": [[0, 10 * x], [10 * x, 0]]} for begin, x in factors]


RUSH = {"over_the_day": [[0, 1], [100, 2], [200, 1]]}
MORNING = {"shift": [100, 480]}
AT_TIMES = {
    # Driving takes a percentage longer at some times of the day.
    "vroom#1280": (
        over_the_day(fleet({"job": {"at": EAST, "window": [130, 130]}}, van=MORNING), **RUSH),
        [110, 130, 150],
    ),
    # Where nothing bounds the visit, the driver leaves after the rush.
    "vroom#347": (over_the_day(fleet({"job": {"at": EAST}}, van=MORNING), **RUSH), [200, 210, 220]),
    # A matrix for the night and another for the day, and a rush hour between them.
    "pyvrp#894": (
        over_the_day(
            fleet({"job": {"at": EAST, "window": [95, 95]}}), slices=slices((0, 1), (100, 3))
        ),
        [85, 95, 115],
    ),
    # Lorries are kept off the motorway for some hours, and have a long way round.
    "vroom#548": (
        over_the_day(
            fleet({"job": {"at": EAST}}, van={"shift": [60, 480]}),
            slices=slices((0, 1), (50, 20), (300, 1)),
        ),
        [300, 310, 320],
    ),
    # Who must leave now is told when he arrives in the traffic as it is then.
    "vroom#1225": (
        over_the_day(fleet({"job": {"at": EAST}}, van=MORNING, leave="early"), **RUSH),
        [100, 120, 140],
    ),
}


@pytest.mark.parametrize("thread", AT_TIMES)
def test_vehicles_arrive_as_the_traffic_of_the_hour_lets_them(thread: str) -> None:
    request, expected = AT_TIMES[thread]
    (route,) = planned(request)["routes"]
    assert route["arrivals"] == expected
    assert route["lengths"][0] == expected[-1] - expected[0]


# In the rush the van drives 40, and the bike half of it by times of its own.
DRIVERS = [
    ({}, {"fixed": 5}, 1, "van"),
    ({"max_driving": 39}, {"fixed": 5}, 1, "bike"),
    ({"max_driving": 40}, {"fixed": 5}, 1, "van"),
    ({"max_distance": 19}, {"fixed": 5}, 1, "bike"),
    ({}, {"fixed": 5}, 0.5, "bike"),
]


@pytest.mark.parametrize(("van", "bike", "factor", "driver"), DRIVERS)
def test_vehicles_that_differ_drive_through_the_rush(
    van: Json, bike: Json, factor: float, driver: str
) -> None:
    """vroom#918 and vroom#654 where it is vroom#1280 as well."""
    request = fleet({"job": {"at": EAST, "window": [130, 130]}}, van={**MORNING, **van})
    request["vehicles"].append({**BIKE, **MORNING, **bike})
    request = over_the_day(by_profile(request, car=1, truck=factor), **RUSH)
    [route] = planned(request)["routes"]
    assert route["vehicle"] == driver
    assert route["arrivals"][1] == 130
    if "max_driving" in van and driver == "van":
        assert route["driving"] == [0, 20, 40]


def sliced(request: Json, *profiles: str) -> Json:
    """Return a request in which some profiles have slices in place of the factors of the day."""
    [time, *others] = json.loads(json.dumps(request["objectives"]))
    factors = time.pop("over_the_day")
    for item in time["matrices"]:
        if item["profile"] in profiles:
            matrix = np.array(item.pop("matrix"))
            item["slices"] = [{"from": at, "matrix": (x * matrix).tolist()} for at, x in factors]
    return {**request, "objectives": [time, *others]}


@pytest.mark.parametrize(("van", "bike", "factor", "driver"), DRIVERS)
def test_profiles_have_slices_of_the_day(van: Json, bike: Json, factor: float, driver: str) -> None:
    """vroom#654 and pyvrp#894: each kind of vehicle is slow at times of its own."""
    request = fleet({"job": {"at": EAST, "window": [130, 130]}}, van={**MORNING, **van})
    request["vehicles"].append({**BIKE, **MORNING, **bike})
    request = over_the_day(by_profile(request, car=1, truck=factor), **RUSH)
    plan = planned(request)
    assert plan["routes"][0]["vehicle"] == driver
    assert planned(sliced(request, "car", "truck")) == plan
    # The bike is as fast in the rush as before.
    fast = sliced(request, "car")
    fast["vehicles"][0]["fixed"] = 100
    [route] = planned(fast)["routes"]
    assert (route["vehicle"], route["arrivals"][0]) == ("bike", 130 - 10 * factor)
    _, source = begun_with("job", fast)
    assert parse_replan(source, LIMITS, {}).subject.stops.changes


def test_slices_of_profiles_fit_each_other() -> None:
    request = over_the_day(by_profile({**fleet(SIDES), "vehicles": VANS}, car=1, truck=2), **RUSH)
    for path, value, code in (
        (["matrices", 1, "slices", 1, "from"], 99, "other-slices"),
        (["matrices", 1, "slices", 1, "from"], 0, "not-later"),
        (["matrices", 1, "slices", 2, "matrix"], [[0]], "row-each"),
        (["matrices", 1, "matrix"], [[0] * 3] * 3, "one-form"),
        (["matrices", 1, "slices"], [], "one-form"),
        (["over_the_day"], RUSH["over_the_day"], "not-beside"),
    ):
        asked = sliced(request, "car", "truck")
        at = asked["objectives"][0]
        for part in path[:-1]:
            at = at[part]
        at[path[-1]] = value
        with pytest.raises(Refusal) as refused:
            planned(asked)
        [fault] = refused.value.errors
        assert fault.code == code
        assert fault.pointer is not None
        assert "/".join(map(str, ["", "objectives", 0, *path])).startswith(fault.pointer)


def test_a_break_is_taken_in_the_rush() -> None:
    """pyvrp#867: a rush hour among the rules that there are."""
    rest = {"breaks": [{"window": [100, 110], "length": 100}], "shift": [80, 480]}
    stops = {"job": {"at": EAST, "window": [100, 100]}}
    (route,) = planned(over_the_day(fleet(stops, van=rest), **RUSH))["routes"]
    assert (route["arrivals"], route["breaks"]) == ([90, 100, 210], [100])


def test_the_rest_of_a_day_is_planned_at_its_own_times() -> None:
    """vroom#1225: it is 120 now, in the rush, and one of two orders is done."""
    stops = {"east": {"at": EAST}, "far": {"at": FAR}}
    request = over_the_day(fleet(stops, van={"shift": [0, 480]}, leave="early"), **RUSH)
    task = parse_task(TaskSource("fleet", json.dumps(request).encode()), LIMITS, {})
    front = run_fleet(task.subject, task, Tools({}, LIMITS), Watch())
    changes = {"now": 120, "routes": [{"route": 0, "done": ["east"]}]}
    source = ReplanSource(json.dumps(changes).encode(), StoredFront("", encode_task(task), front))
    rest = parse_replan(source, LIMITS, {})
    document = run_fleet(rest.subject, rest, Tools({}, LIMITS), Watch())
    [plan, *_] = json.loads(document.json(id="", status="done"))["front"]
    assert [route["arrivals"] for route in plan["routes"]] == [[120, 140, 180]]


@pytest.mark.parametrize(
    ("members", "pointer", "code"),
    [
        ({"clock": None, "vehicles": [{"id": "van", "start": 0}]}, "/clock", "no-clock-of-day"),
        ({"time_limit": 0}, None, "no-actor"),
    ],
)
def test_a_day_needs_a_clock_and_without_time_a_network(
    members: Json, pointer: str | None, code: str
) -> None:
    stops = {f"{at}": {"at": at} for at in range(7)}
    request = {**over_the_day(fleet(stops), **RUSH), **members}
    with pytest.raises(Refusal) as refused:
        planned(request)
    assert code in (refused.value.code, *(each.code for each in refused.value.errors))
    assert pointer is None or refused.value.errors[0].pointer == pointer


def test_the_clock_of_a_day_is_in_seconds() -> None:
    request = over_the_day(fleet({"job": {"at": EAST}}), **RUSH, unit="min")
    with pytest.raises(Refusal, match="must be s"):
        planned(request)
