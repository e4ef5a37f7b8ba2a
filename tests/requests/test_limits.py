"""Requests over a limit are refused, and defaults never are."""

from dataclasses import replace
from typing import Any

import pytest

from service.errors import Refusal
from service.requests.limits import check_limits, limited_schema, lower_defaults
from service.requests.schemas import PlanRequest
from tests.helpers.serving import LIMITS

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
        check_limits(PlanRequest.model_validate({member: value}), N, LIMITS)
    assert (refused.value.status, refused.value.code) == (422, "over-limit")
    assert (refused.value.limit, refused.value.actual) == (limit, limit + 1)
    assert refused.value.errors[0].pointer == f"/{member}"


def test_arrivals_are_bounded_by_the_stops_of_all_tours() -> None:
    limits = replace(LIMITS, size=100, path_cells=10 * (N + 1))
    check_limits(PlanRequest(size=10, arrivals=True), N, limits)
    check_limits(PlanRequest(size=11), N, limits)
    with pytest.raises(Refusal, match="size must be at most 10 with arrivals of 12 cities, got 11"):
        check_limits(PlanRequest(size=11, arrivals=True), N, limits)


def test_preferences_that_are_lowered_still_count_as_not_given() -> None:
    few = replace(LIMITS, preferences=7)
    silent = lower_defaults(PlanRequest(time_limit=0.1), few).options()
    assert (len(silent.angles), silent.fewer) == (7, True)
    asked = lower_defaults(PlanRequest(preferences=5), few).options()
    assert (len(asked.angles), asked.fewer) == (5, False)


@pytest.mark.parametrize("tour", [[0], [*range(1, N), 1], [*range(1, N), N]])
def test_an_initial_tour_that_is_no_tour_is_named(tour: list[int]) -> None:
    request = PlanRequest(initial_tours=[list(range(N)), tour])
    with pytest.raises(Refusal, match=r"initial_tours/1 must visit each city, 0 to 11, once"):
        check_limits(request, N, LIMITS)


def test_a_start_must_be_a_city() -> None:
    check_limits(PlanRequest(start=N - 1), N, LIMITS)
    with pytest.raises(Refusal, match="start must be a city, 0 to 11, got 12"):
        check_limits(PlanRequest(start=N), N, LIMITS)


def test_a_default_over_a_limit_is_lowered_and_what_was_asked_for_is_not() -> None:
    silent = lower_defaults(PlanRequest(), LIMITS)
    assert (silent.preferences, silent.size) == (LIMITS.preferences, LIMITS.size)
    assert silent.time_limit == LIMITS.seconds
    asked = lower_defaults(PlanRequest(size=7), replace(LIMITS, preferences=1000))
    assert (asked.size, asked.preferences) == (7, 100)


def test_the_schema_has_the_limits_and_the_actors() -> None:
    fields = limited_schema(PlanRequest, LIMITS, ["b", "a"])["properties"]
    assert fields["size"]["maximum"] == fields["size"]["default"] == LIMITS.size
    assert fields["time_limit"]["maximum"] == LIMITS.seconds
    assert fields["start"]["maximum"] == LIMITS.cities - 1
    assert fields["actor"]["enum"] == ["a", "b"]
