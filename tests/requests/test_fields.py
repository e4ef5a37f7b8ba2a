"""The fields that all requests for a front share."""

import numpy as np
import pytest

from service.errors import Refusal
from service.preferences import from_angles
from service.requests.fields import PlanRequest
from service.requests.validation import parse_json


@pytest.mark.parametrize(
    ("member", "pointer", "sentence"),
    [
        ('"preferences": 0', "/preferences", "preferences must be at least 1, got 0"),
        ('"preferences": []', "/preferences", "preferences must have 1 item or more, got 0"),
        ('"preferences": [0, -1]', "/preferences/1", "preferences/1 must be at least 0, got -1"),
        ('"preferences": [90.5]', "/preferences/0", "preferences/0 must be at most 90, got 90.5"),
        ('"preferences": [NaN]', "/preferences/0", "must be a finite number, got NaN"),
        ('"preferences": true', "/preferences", "preferences must be a valid integer, got true"),
        ('"preferences": "9"', "/preferences", 'preferences must be a valid integer, got "9"'),
        ('"preferences": 1.5', "/preferences", "preferences must be a valid integer, got 1.5"),
        ('"time_limit": -1', "/time_limit", "time_limit must be at least 0, got -1"),
        ('"time_limit": NaN', "/time_limit", "time_limit must be a finite number, got NaN"),
        ('"size": 0', "/size", "size must be at least 1, got 0"),
        ('"size": 1e10', "/size", "size must be at most 2147483647, got 10000000000"),
        ('"start": -1', "/start", "start must be at least 0, got -1"),
        ('"reference_point": [1]', "/reference_point", "must have 2 items or more, got 1"),
        ('"reference_point": [0, 1]', "/reference_point/0", "must be at least 1e-150, got 0"),
        ('"reference_point": 1', "/reference_point", "must be a valid array, got 1"),
        ('"actor": 1', "/actor", "actor must be a valid string, got 1"),
        ('"seed": -1', "/seed", "seed must be at least 0, got -1"),
        ('"cities": 1', "/cities", "cities is not a field that this request has"),
        ('"tims_limit": 1', "/tims_limit", "request has; did you mean time_limit?"),
        ('"a/b~c": 1', "/a~1b~0c", "is not a field that this request has"),
    ],
)
def test_a_wrong_member_is_named(member: str, pointer: str, sentence: str) -> None:
    with pytest.raises(Refusal) as refused:
        parse_json(PlanRequest, f"{{{member}}}".encode())
    [fault] = refused.value.errors
    assert (refused.value.code, fault.pointer) == ("invalid-request", pointer)
    assert sentence in fault.detail


def test_a_whole_number_may_be_written_with_a_point() -> None:
    request = parse_json(PlanRequest, b'{"preferences": 3.0, "start": 2.0}')
    assert (request.preferences, request.start) == (3, 2)


def test_preferences_become_angles() -> None:
    even = parse_json(PlanRequest, b'{"preferences": 3}')
    given = parse_json(PlanRequest, b'{"preferences": [0, 12.5]}')
    np.testing.assert_allclose(even.options().directions, from_angles(np.array([15, 45, 75])))
    np.testing.assert_array_equal(given.options().directions, from_angles(np.array([0, 12.5])))


def test_an_actor_is_requested_by_name_or_not_at_all() -> None:
    assert parse_json(PlanRequest, b"{}").requested_actor is None
    assert parse_json(PlanRequest, b'{"actor": "pa-one"}').requested_actor == "pa-one"
