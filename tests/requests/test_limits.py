"""Requests over a limit are refused, and defaults never are."""

import json
from dataclasses import replace
from typing import Any

import pytest

from service.errors import Refusal
from service.kinds.parsing import parse_task
from service.requests.fields import PlanRequest
from service.requests.json_schemas import limited_schemas
from service.requests.limits import (
    check_structure,
    tours_within_limits,
    within_limits,
    within_network,
)
from service.requests.task import TaskSource
from tests.helpers.serving import ACTORS, LIMITS

N = 12


@pytest.mark.parametrize(
    ("member", "value", "limit"),
    [
        ("preferences", LIMITS.preferences + 1, LIMITS.preferences),
        ("preferences", [45.0] * (LIMITS.preferences + 1), LIMITS.preferences),
        ("size", LIMITS.size + 1, LIMITS.size),
        ("time_limit", LIMITS.seconds + 1, LIMITS.seconds),
        ("initial_tours", [list(range(N))] * (LIMITS.size + 1), LIMITS.size),
    ],
)
def test_more_than_a_limit_names_the_limit(member: str, value: Any, limit: float) -> None:
    with pytest.raises(Refusal) as refused:
        tours_within_limits(PlanRequest.model_validate({member: value}), N, LIMITS)
    assert (refused.value.status, refused.value.code) == (422, "over-limit")
    assert (refused.value.limit, refused.value.actual) == (limit, limit + 1)
    assert refused.value.errors[0].pointer == f"/{member}"


def test_tours_are_bounded_by_the_stops_of_all() -> None:
    limits = replace(LIMITS, size=100, path_cells=10 * (N + 1))
    tours_within_limits(PlanRequest(size=10), N, limits)
    with pytest.raises(Refusal, match="size must be at most 10 with 12 cities, got 11"):
        tours_within_limits(PlanRequest(size=11), N, limits)
    assert within_limits(PlanRequest(), N, limits).size == 10
    assert within_limits(PlanRequest(), 10**6, limits).size == 1


@pytest.mark.parametrize("members", [{"time_limit": 0}, {"preferences": 3}, {"preferences": [9]}])
def test_of_more_cities_than_a_network_serves_its_tours_are_refused(members: Any) -> None:
    limits = replace(LIMITS, network_cities=N - 1)
    options = PlanRequest.model_validate(members).options()
    with pytest.raises(Refusal, match="at most 11 cities, got 12: give a time_limit") as refused:
        within_network(options, N, limits)
    assert (refused.value.status, refused.value.code) == (413, "too-many-for-network")
    assert (refused.value.limit, refused.value.actual) == (N - 1, N)
    assert refused.value.errors[0].pointer == f"/{next(iter(members))}"
    assert within_network(options, N - 1, limits) is options


def test_of_more_cities_than_a_network_serves_the_search_is_alone() -> None:
    options = within_network(PlanRequest().options(), N, replace(LIMITS, network_cities=N - 1))
    assert (len(options.directions), options.time_limit) == (0, 1.0)


def test_preferences_that_are_lowered_still_count_as_not_given() -> None:
    few = replace(LIMITS, preferences=7)
    silent = within_limits(PlanRequest(time_limit=0.1), N, few).options()
    assert (len(silent.directions), silent.fewer) == (7, True)
    asked = within_limits(PlanRequest(preferences=5), N, few).options()
    assert (len(asked.directions), asked.fewer) == (5, False)


@pytest.mark.parametrize("tour", [[0], [*range(1, N), 1], [*range(1, N), N]])
def test_an_initial_tour_that_is_no_tour_is_named(tour: list[int]) -> None:
    request = PlanRequest(initial_tours=[list(range(N)), tour])
    with pytest.raises(Refusal, match=r"initial_tours/1 must visit each city, 0 to 11, once"):
        tours_within_limits(request, N, LIMITS)


def test_a_start_must_be_a_city() -> None:
    tours_within_limits(PlanRequest(start=N - 1), N, LIMITS)
    with pytest.raises(Refusal, match="start must be a city, 0 to 11, got 12"):
        tours_within_limits(PlanRequest(start=N), N, LIMITS)


@pytest.mark.parametrize(
    ("members", "sentence"),
    [
        ({"end": 1}, "end is for open routes, with closed false, got 1"),
        ({"closed": False, "end": N}, "end must be a city, 0 to 11, got 12"),
        ({"closed": False, "end": 0}, "end must not be the start, or tours are closed, got 0"),
        ({"closed": False, "start": 3, "end": 3}, "end must not be the start"),
        (
            {"closed": False, "initial_tours": [[*range(N)][::-1]]},
            "initial_tours/0 must start at city 0, got 11",
        ),
        (
            {"closed": False, "end": 4, "initial_tours": [[*range(N)]]},
            "initial_tours/0 must end at city 4, got 11",
        ),
    ],
)
def test_ends_that_no_route_can_have_are_refused(members: Any, sentence: str) -> None:
    with pytest.raises(Refusal, match=sentence):
        tours_within_limits(PlanRequest.model_validate(members), N, LIMITS)


@pytest.mark.parametrize("ends", [(None, None), (0, None), (None, N - 1), (0, N - 1)])
def test_ends_that_a_route_can_have_are_those_of_the_request(ends: tuple[Any, Any]) -> None:
    start, end = ends
    request = PlanRequest(closed=False, start=start, end=end, initial_tours=[list(range(N))])
    tours_within_limits(request, N, LIMITS)
    assert request.ends == (False, start, end)


def test_of_one_city_both_ends_are_the_same_and_closed_tours_have_none() -> None:
    tours_within_limits(PlanRequest(closed=False, start=0, end=0), 1, LIMITS)
    assert PlanRequest(start=3).ends == (True, None, None)


def test_a_default_over_a_limit_is_lowered_and_what_was_asked_for_is_not() -> None:
    silent = within_limits(PlanRequest(), N, LIMITS)
    assert (silent.preferences, silent.size) == (LIMITS.preferences, LIMITS.size)
    assert silent.time_limit == LIMITS.seconds
    asked = within_limits(PlanRequest(size=7), N, replace(LIMITS, preferences=1000))
    assert (asked.size, asked.preferences) == (7, 100)


def test_the_schema_has_the_limits_and_the_actors() -> None:
    schemas = limited_schemas(PlanRequest, LIMITS, ["b", "a"])
    fields = schemas["PlanRequest"]["properties"]
    assert fields["size"]["maximum"] == fields["size"]["default"] == LIMITS.size
    assert fields["time_limit"]["maximum"] == LIMITS.seconds
    for name in ("start", "end"):
        assert fields[name]["anyOf"][0]["maximum"] == LIMITS.cities - 1
    assert fields["actor"]["enum"] == ["a", "b"]


@pytest.mark.parametrize("path", ["front", "fleet"])
def test_breakpoints_of_all_objectives_have_a_limit_of_their_own(path: str) -> None:
    one = [[0, 5]]
    times = [[None, [[0, 5], [60, 9]], one], [one, None, one], [one, None, None]]
    tolls = [[pair and one for pair in row] for row in times]
    body = {
        "stops": [{"id": name} for name in "abc"],
        "objectives": [
            {"name": "time", "breakpoints": times},
            {"name": "tolls", "breakpoints": tolls},
        ],
        **(
            {"vehicles": [{"id": "van", "start": "a"}], "clock": "time"}
            if path == "fleet"
            else {"departure": 0}
        ),
    }
    source = TaskSource(path, json.dumps(body).encode())
    actors = {actor.info.name: actor.info for actor in ACTORS}
    parse_task(source, replace(LIMITS, breakpoints=11), actors)
    with pytest.raises(Refusal, match="at most 10 breakpoints, got 11") as refused:
        parse_task(source, replace(LIMITS, breakpoints=10), actors)
    assert (refused.value.limit, refused.value.actual) == (10, 11)
    assert refused.value.errors[0].pointer == "/objectives/0/breakpoints"  # which has more


@pytest.mark.parametrize(
    ("times", "code", "member"),
    [
        ({"from": "road_time"}, "no-router", "from"),
        (
            {"from": "road_time", "traffic": {"date": "2026-03-02", "at": [0]}},
            "no-traffic",
            "traffic",
        ),
        ({"breakpoints": [[None, [[0, 5]]], [[[0, 5]], None]]}, "invalid-request", "breakpoints"),
    ],
)
@pytest.mark.parametrize("in_clock", [False, True])
def test_refused_times_of_a_fleet_are_named_where_they_stand(
    times: dict[str, Any], code: str, member: str, in_clock: bool
) -> None:
    way = {"name": "way", "coordinates": [[0, 0], [1, 1]]}
    vans = {"name": "vans", "measure": "vehicles"}
    own = {"name": "time", **times}
    body = {
        "stops": [{"id": name, "location": [24.9, 60.2]} for name in "ab"],
        "objectives": [way, vans] if in_clock else [way, vans, own],
        "vehicles": [{"id": "van", "start": "a"}],
        "clock": own if in_clock else "time",
    }
    actors = {actor.info.name: actor.info for actor in ACTORS}
    with pytest.raises(Refusal) as refused:
        parse_task(
            TaskSource("fleet", json.dumps(body).encode()), replace(LIMITS, breakpoints=1), actors
        )
    part = "clock" if in_clock else "objectives/2"
    assert refused.value.code == code
    assert refused.value.errors[0].pointer == f"/{part}/{member}"


def test_as_many_arrays_may_come_as_the_most_breakpoints_need() -> None:
    limits = replace(LIMITS, breakpoints=10_000)
    check_structure(b"[" * 20_000, limits)
    with pytest.raises(Refusal) as refused:
        check_structure(b"[" * 22_000, limits)
    assert refused.value.code == "body-too-complex"


def test_colons_in_texts_are_no_members() -> None:
    limits = replace(LIMITS, cities=10)
    check_structure(json.dumps(["a:b:c:d"] * 900).encode(), limits)
    spaced = b'{"a"\t \n: 0, "b" :0}'
    check_structure(spaced * 600, limits)
    with pytest.raises(Refusal, match="at most 1320 members, got 1400"):
        check_structure(spaced * 700, limits)
