"""Front requests with coordinates or matrices, and every refusal of them."""

import io
import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from service.errors import Refusal
from service.instance import Instance, tour_lengths
from service.requests.front import FrontRequest, parse_front_request
from tests.helpers.serving import LIMITS

COSTS = np.random.default_rng(6).random((2, 12, 12))
SQUARE = "[[0, 1, 2], [1, 0, 3], [2, 3, 0]]"
ONE_CITY = [[1, 2, 3, 4]]


def refusal(body: str | dict[str, Any], npy: bytes | None = None) -> Refusal:
    body = body if isinstance(body, str) else json.dumps(body)
    with pytest.raises(Refusal) as refused:
        parse_front_request(body.encode(), LIMITS, npy)
    return refused.value


def instance_of(request: FrontRequest) -> Instance:
    return request.subject.instance


@pytest.mark.parametrize(
    ("body", "pointer", "sentence"),
    [
        ("{}", "/coordinates", "one of coordinates, matrices and stops is required, got none"),
        (
            '{"coordinates": [[1, 2, 3, 4]], "matrices": [[[0]], [[0]]]}',
            "/coordinates",
            "one of coordinates, matrices and stops is required, got coordinates and matrices",
        ),
        ('{"coordinates": []}', "/coordinates", "coordinates must have 1 item or more, got 0"),
        (
            '{"coordinates": [[1, 2, 3, 4], [1, 2, 3]]}',
            "/coordinates/1",
            "coordinates/1 must have 4 items or more, got 3",
        ),
        (
            '{"coordinates": [[1, 2, 3, 4, 5]]}',
            "/coordinates/0",
            "coordinates/0 must have 4, 6 or 8 numbers, x and y in the plane of each objective,"
            " got 5",
        ),
        ('{"coordinates": [7]}', "/coordinates/0", "coordinates/0 must be a valid array, got 7"),
        ('{"coordinates": "x"}', "/coordinates", 'coordinates must be a valid array, got "x"'),
        (
            '{"coordinates": [[1, 2, 3, 4]], "augment": 0}',
            "/augment",
            "augment must be at least 1, got 0",
        ),
        (
            '{"coordinates": [[1, 2, 3, 4]], "augment": 9}',
            "/augment",
            "augment must be at most 8, got 9",
        ),
        (
            '{"coordinates": [[1, 2, 3, 4]], "repairs": -1}',
            "/repairs",
            "repairs must be at least 0, got -1",
        ),
        (
            '{"coordinates": [[1, 2, 3, 4]], "repairs": 1.5}',
            "/repairs",
            "repairs must be a valid integer, got 1.5",
        ),
    ],
)
def test_what_is_no_front_request_is_named(body: str, pointer: str, sentence: str) -> None:
    refused = refusal(body)
    assert (refused.code, refused.errors[0].pointer) == ("invalid-request", pointer)
    assert refused.detail == sentence


@pytest.mark.parametrize(
    ("number", "sentence"),
    [
        ("NaN", "must be a finite number, got NaN"),
        ("Infinity", "must be a finite number, got Infinity"),
        ("-Infinity", "must be a finite number, got -Infinity"),
        ("1e400", "must be a finite number, got Infinity"),
        ("1" + 400 * "0", "must be a finite number, got an integer of more than 40 digits"),
        ("1e200", "must be at most 1e+150, got 1e+200"),
        ('"4"', 'must be a valid number, got "4"'),
        ("true", "must be a valid number, got true"),
        ("null", "must be a valid number, got null"),
        ("[4]", "must be a valid number, got a list of 1"),
        ("{}", "must be a valid number, got an object"),
    ],
)
def test_a_wrong_coordinate_is_named(number: str, sentence: str) -> None:
    refused = refusal(f'{{"coordinates": [[1, 2, {number}, 4]]}}')
    assert refused.errors[0].pointer == "/coordinates/0/2"
    assert refused.detail == f"coordinates/0/2 {sentence}"


@pytest.mark.parametrize(
    ("matrices", "pointer", "sentence"),
    [
        ("7", "", "must be a valid array, got 7"),
        (f"[{SQUARE}]", "", "must have 2 items or more, got 1"),
        (f"[{', '.join([SQUARE] * 5)}]", "", "must have 4 items or fewer, got 5"),
        (f"[{SQUARE}, 7]", "/1", "must be a valid array, got 7"),
        (f"[[[0], 7, [2]], {SQUARE}]", "/0/1", "must be a valid array, got 7"),
        (f"[{SQUARE}, [[0, -0.5], [1, 0]]]", "/1", "must have 3 rows, as many as matrices/0"),
        (f"[{SQUARE}, [[0, 1, 2], [1, 0, -0.5], [2, 3, 0]]]", "/1/1/2", "must not be negative"),
        (f"[{SQUARE}, [[0, 1, 2], [1, 0, NaN], [2, 3, 0]]]", "/1/1/2", "must be a finite number"),
        (f'[{SQUARE}, [[0, 1, 2], [1, 0, "4"], [2, 3, 0]]]', "/1/1/2", "must be a valid number"),
        (f"[{SQUARE}, [[0, 1, 2], [1, 0, true], [2, 3, 0]]]", "/1/1/2", "must be a valid number"),
        (f"[{SQUARE}, [[0, 1, 2], [1, 0, [4]], [2, 3, 0]]]", "/1/1/2", "must be a valid number"),
    ],
)
def test_what_is_not_two_matrices_of_costs_is_named(
    matrices: str, pointer: str, sentence: str
) -> None:
    refused = refusal(f'{{"matrices": {matrices}}}')
    assert (refused.code, refused.errors[0].pointer) == ("invalid-request", f"/matrices{pointer}")
    assert refused.detail.startswith(f"matrices{pointer} {sentence}")


def test_fewer_cities_are_allowed_where_costs_are_matrices() -> None:
    limits = replace(LIMITS, matrix_cities=2)
    stops = {"stops": [{"id": each} for each in "abc"]}
    plane = {"name": "a", "coordinates": [[0, 0]] * 3}
    planes = [plane, {**plane, "name": "b"}]
    for within in ({"coordinates": [[0, 0, 0, 0]] * 3}, {**stops, "objectives": planes}):
        assert parse_front_request(json.dumps(within).encode(), limits).n == 3
    matrix = {"name": "b", "matrix": [[1] * 3] * 3}
    for over, sentence in (
        ({"matrices": [[[1] * 3] * 3] * 2}, "matrices must have at most 2 rows, got 3"),
        (
            {**stops, "objectives": [plane, matrix]},
            "stops must have at most 2 rows unless all objectives have coordinates, got 3",
        ),
    ):
        with pytest.raises(Refusal) as refused:
            parse_front_request(json.dumps(over).encode(), limits)
        assert (refused.value.code, refused.value.detail) == ("too-many-cities", sentence)


@pytest.mark.parametrize(("member", "city"), [("coordinates", [0, 0, 0, 0]), ("matrices", None)])
def test_too_many_cities_are_refused(member: str, city: list[int] | None) -> None:
    n = LIMITS.cities + 1
    refused = refusal({member: [city] * n if city else [[[1] * n] * n] * 2})
    assert (refused.status, refused.code) == (413, "too-many-cities")
    assert (refused.limit, refused.actual) == (LIMITS.cities, n)
    assert refused.detail == f"{member} must have at most 50 rows, got 51"


@pytest.mark.parametrize(
    ("request_", "sentence"),
    [
        ({"matrices": COSTS.tolist()}, "matrices must come once, got them as a part as well"),
        (
            {"coordinates": ONE_CITY},
            "one of coordinates, matrices and stops is required, got coordinates and matrices",
        ),
    ],
)
def test_cities_may_not_come_beside_a_file(request_: dict[str, Any], sentence: str) -> None:
    stream = io.BytesIO()
    np.save(stream, COSTS)
    assert refusal(request_, stream.getvalue()).detail == sentence


def test_coordinates_matrices_and_a_file_become_an_instance() -> None:
    stream = io.BytesIO()
    np.save(stream, COSTS)
    request = parse_front_request(json.dumps({"coordinates": ONE_CITY}).encode(), LIMITS)
    assert (request.kind, request.n) == ("coordinates", 1)
    for body, npy in (({"matrices": COSTS.tolist()}, None), ({}, stream.getvalue())):
        request = parse_front_request(json.dumps(body).encode(), LIMITS, npy)
        assert (request.kind, request.n) == ("matrices", 12)
        matrices = instance_of(request).matrices
        assert matrices is not None
        np.testing.assert_array_equal(matrices, COSTS * (1 - np.eye(12)))


def test_the_diagonal_is_disregarded() -> None:
    odd = COSTS.copy()
    odd[:, range(12), range(12)] = [[-1], [1e308]]
    body = json.dumps({"matrices": odd.tolist()}).replace("1e+308", "NaN")
    tours = np.array([np.random.default_rng(0).permutation(12)])
    lengths = [
        tour_lengths(instance_of(parse_front_request(text.encode(), LIMITS)), tours)
        for text in (body, json.dumps({"matrices": COSTS.tolist()}))
    ]
    np.testing.assert_array_equal(*lengths)
