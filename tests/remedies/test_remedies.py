"""Remedies of fleets without a plan: which are found, and that each of them works."""

import json
import time
from typing import Any

import numpy as np
import pytest
from paretour import Refused

from service.errors import Refusal
from service.kinds.fleet import run_fleet, warm_up
from service.kinds.front_document import FrontDocument
from service.kinds.kind import Tools
from service.kinds.parsing import parse_replan, parse_task
from service.requests.limits import Limits
from service.requests.replan.way import ReplanSource
from service.requests.task import Task, TaskSource, UnmeasuredFleet
from service.watch import Watch
from tests.helpers.actors import info_of
from tests.helpers.offers import FIVE, as_stored, fleet_request, stored_fleet
from tests.helpers.sampled import IS_WHOLE, third

LIMITS = Limits(body_bytes=10**6, cities=100, cells=900, preferences=20, size=30, seconds=2)
MEMBERS = {"code", "detail", "values", "patch"}
STOPS = 8


def request(**members: Any) -> dict[str, Any]:
    """Return a request about a van and stops on a line, at 1 to 8, whose orders are one each."""
    line = np.abs(np.subtract.outer(range(STOPS + 1), range(STOPS + 1))).tolist()
    stops: list[dict[str, Any]] = [{"id": f"stop-{i}", "demand": [1]} for i in range(STOPS + 1)]
    del stops[0]["demand"]
    return {
        "stops": stops,
        "vehicles": [{"id": "van", "start": 0, "end": "stop-0", "capacity": [STOPS], **members}],
        "objectives": [
            {"name": "time", "unit": "min", "matrix": line},
            {"name": "longest", "unit": "min", "matrix": line, "over": "max"},
        ],
        "clock": "time",
        "time_limit": 0.4,
    }


def planned(request: dict[str, Any]) -> FrontDocument:
    """Return the front of a request, by a clock that stands still while others compute."""
    source = TaskSource("fleet", json.dumps(request).encode())
    return run(parse_task(source, LIMITS, {}))


def run(task: Task) -> FrontDocument:
    """Return the front of a task, in the same way."""
    assert isinstance(task.subject, UnmeasuredFleet)
    watch = Watch[FrontDocument](clock=time.process_time)
    return run_fleet(task.subject, task, Tools({}, LIMITS), watch)


def refused(request: dict[str, Any]) -> Refused:
    """Return the refusal of a request."""
    with pytest.raises(Refusal) as raised:
        planned(request)
    assert raised.value.code == "no-plan"
    return Refused(raised.value.document(""))


def of_stops(request: dict[str, Any], *stops: int, **members: Any) -> dict[str, Any]:
    """Return the request with more members of some stops."""
    for stop in stops:
        request["stops"][stop] |= members
    return request


def mixed(*capacities: int, **members: Any) -> dict[str, Any]:
    """Return a request about vehicles that hold so much, and a truck, the last, with members."""
    asked = request()
    [van] = asked["vehicles"]
    held = enumerate(capacities)
    vehicles = [{**van, "id": f"van {number}", "capacity": [each]} for number, each in held]
    vehicles[-1] |= {"id": "truck", **members}
    return {**asked, "vehicles": vehicles}


@pytest.fixture(scope="module", autouse=True)
def loaded() -> None:
    """Load the compiled search, which must not be in the time of a trial."""
    warm_up()


TABLE: dict[str, tuple[dict[str, Any], dict[str, dict[str, Any]]]] = {
    "too little capacity": (
        request(capacity=[5]),
        {
            "leave-out": {"prize": 30, "visited": 5, "stops": STOPS},
            "load-again": {},
            "more-vehicles": {"vehicle": "van", "count": 2, "before": 1},
            "larger-vehicles": {"vehicle": "van", "share": 50, "holds": "8", "before": "5"},
        },
    ),
    "too few trips": (request(capacity=[2], reload=[0], max_trips=2), {"load-again": {}}),
    "a short shift": (
        request(shift=[480, 492]),
        {
            "longer-shifts": {"more": 15, "text": "15 min"},
            "leave-these-out": {"named": "stops 'stop-7' and 'stop-8'"},
        },
    ),
    "an early window": (
        of_stops(request(shift=[480, 600]), 8, window=[480, 485]),
        {"later-windows": {"named": "stop 'stop-8'", "more": 15, "text": "15 min"}},
    ),
    "early windows, each in a list": (
        of_stops(request(shift=[480, 600]), 7, 8, windows=[[480, 482], [483, 484]]),
        {"later-windows": {"named": "stops 'stop-7' and 'stop-8'"}},
    ),
    "a window before the shift": (
        of_stops(request(shift=[480, 600]), 8, window=[400, 470]),
        {"leave-these-out": {"named": "stop 'stop-8'"}, "earlier-shifts": {"more": 30}},
    ),
    "short routes": (request(longest=12), {"longer-routes": {"share": 50}}),
    "little driving": (request(max_driving=12, max_distance=100), {"longer-routes": {"share": 50}}),
    "a mixed fleet": (
        of_stops(mixed(*(3 for _ in range(4)), 9, max_stops=1), 1, 2, demand=[9]),
        {"more-vehicles": {"vehicle": "truck", "before": 1}},
    ),
    "few stops of a route": (request(max_stops=5), {"more-stops": {"more": 3}}),
    "a skill that nobody has": (
        of_stops(request(), 2, 3, skills=["lift"]),
        {"more-skills": {"skills": "'lift'"}},
    ),
}


def test_all_are_told_with_the_first_error_alone() -> None:
    asked = of_stops(request(), 1, 2, demand=[9])
    first, *others = refused(asked).errors
    codes = {remedy["code"] for remedy in first["remedies"]}
    assert codes >= {"leave-these-out", "larger-vehicles"}
    assert all(remedy.keys() == MEMBERS for remedy in first["remedies"])
    assert others
    assert not any("remedies" in each for each in others)


def varied(asked: dict[str, Any], seed: int) -> dict[str, Any]:
    """Return a request like another one, with random distances and a second vehicle."""
    random = np.random.default_rng(seed)
    places = random.uniform(0, STOPS, (STOPS + 1, 2))
    costs = np.abs(places[:, np.newaxis] - places).sum(axis=2).tolist()
    objectives = [{**each, "matrix": costs} for each in asked["objectives"]]
    bike = {"id": "bike", "start": "stop-0", "capacity": [1]}
    return {**asked, "objectives": objectives, "vehicles": [*asked["vehicles"], bike]}


def check_that_all_help(asked: dict[str, Any], refusal: Refused) -> None:
    for remedy in refusal.remedies:
        applied = {**remedy.applied_to(asked), "time_limit": 0.1}
        assert planned(applied).tours, remedy


@pytest.mark.parametrize("case", TABLE)
def test_what_helps_is_told_with_its_values_and_does(case: str) -> None:
    asked, expected = TABLE[case]
    refusal = refused(asked)
    found = {remedy.code: remedy for remedy in refusal.remedies}
    assert expected.keys() <= found.keys()
    for code, values in expected.items():
        assert values.items() <= found[code].values.items(), code
    check_that_all_help(asked, refusal)


# A request of each kind is tried above: by day a few of others like them.
@pytest.mark.parametrize("case", list(TABLE) if IS_WHOLE else list(TABLE)[::3])
def test_whatever_is_told_of_a_request_helps(case: str) -> None:
    for seed in range(third(3)):
        asked = varied(TABLE[case][0], seed)
        try:
            planned(asked)
        except Refusal as refusal:
            check_that_all_help(asked, Refused(refusal.document("")))


@pytest.mark.parametrize("on_the_way", [0, 1, 2])
def test_where_all_shifts_are_over_overtime_from_now_on_helps(on_the_way: int) -> None:
    """However many vans have left: as their shifts are over, none may go on."""
    asked = fleet_request()
    for stop in asked["stops"]:
        stop.pop("window", None)
    front = as_stored(stored_fleet(asked))
    routes = json.loads(front.found.split()[0])["routes"][:on_the_way]
    ways = [{"route": n, "done": each["stops"][1:3]} for n, each in enumerate(routes)]
    late = {"plan": 0, "now": FIVE + 600, "routes": ways, "time_limit": 1}

    def replanned(body: dict[str, Any]) -> FrontDocument:
        source = ReplanSource(json.dumps(body).encode(), front)
        return run(parse_replan(source, LIMITS, {}))

    with pytest.raises(Refusal) as raised:
        replanned(late)
    remedies = {each.code: each for each in Refused(raised.value.document("")).remedies}
    remedy = remedies["later-than-now"]
    plans = json.loads(b"[%b]" % replanned(remedy.applied_to(late)).tours)
    for route in (route for each in plans for route in each["routes"]):
        assert route["arrivals"][0] >= FIVE + 600
        assert route["arrivals"][-1] <= FIVE + 600 + remedy.values["more"] + 1e-6


def test_without_a_routing_engine_great_circles_are_a_remedy() -> None:
    places = [{"id": str(i), "location": [24.9 + i / 100, 60.2]} for i in range(5)]
    measured = {"name": "time", "unit": "s", "from": "road_time", "over_the_day": [[0, 1], [9, 2]]}
    risk = {"name": "risk", "matrix": [[1] * 5] * 5}
    asked = {"stops": places, "objectives": [risk, measured], "departure": 5}

    actors = {"pa-one-matrix": info_of("pa-one-matrix", "matrices")}

    def read(asked: dict[str, Any]) -> None:
        parse_task(TaskSource("front", json.dumps(asked).encode()), LIMITS, actors)

    with pytest.raises(Refusal) as raised:
        read(asked)
    (remedy,) = Refused(raised.value.document("")).remedies
    assert remedy.code == "great-circles"
    read(remedy.applied_to(asked))
    with pytest.raises(Refusal) as raised:
        read({**asked, "departure": -1})  # after which there is still a fault
    assert raised.value.remedies == ()
