"""What schemathesis has to know beyond the OpenAPI document."""

import uuid
from typing import Any

import schemathesis


@schemathesis.hook
def before_call(context: Any, case: Any, kwargs: dict[str, Any]) -> None:  # noqa: ARG001
    """No schema can say that a matrix is square, that its costs are not negative but on the
    diagonal, that some actors read no matrices, that a start is one of the cities, that a tour
    visits each once, that places are free cells of a grid, nor that a key belongs to one body.
    """
    if _is_key((case.headers or {}).get("Idempotency-Key")):
        case.headers["Idempotency-Key"] = uuid.uuid4().hex
    match case.body:
        case {"grid": _} as body if case.meta.generation.mode.is_positive:
            _make_coverable(body)
        case {"coordinates": [_, *_] as rows, **others}:
            _make_fit(case.body, len(rows), others)
        case {"matrices": [[_, *_] as rows, _] as matrices, **others} if _are_matrices(matrices):
            case.body["matrices"] = [[[1.0] * len(rows)] * len(rows)] * 2
            if others.get("actor") == "pa-one":
                case.body["actor"] = "pa-one-matrix"
            _make_fit(case.body, len(rows), others)


def _make_coverable(body: dict[str, Any]) -> None:
    """Replaces a task that the schema allows by one that can be done."""
    body |= {"grid": [[0, 0], [0, 0]], "robot_radius": 0, "start": 0, "actor": "pa-one-matrix"}
    body.pop("initial_tours", None)
    n = 2 if "places" in body else 1
    fit = {
        "places": [[0, 0], [1, 1]],
        "spacing": 1e150,
        "second_matrix": [[1.0] * n] * n,
        "cost_layer": [[1.0, 1.0], [1.0, 1.0]],
        "second_coordinates": [[0.0, 1.0]] * n,
    }
    body |= {name: value for name, value in fit.items() if name in body}


def _make_fit(body: dict[str, Any], n: int, others: dict[str, Any]) -> None:
    if isinstance(others.get("start"), int | float) and others["start"] >= n:
        body["start"] = 0
    if _are_tours(others.get("initial_tours")):
        body["initial_tours"] = [list(range(n))]


def _are_matrices(given: list[Any]) -> bool:
    """Whether the schema takes them for matrices."""
    return all(
        isinstance(rows, list)
        and rows != []
        and all(isinstance(row, list) and all(map(_is_number, row)) for row in rows)
        for rows in given
    )


def _are_tours(given: Any) -> bool:
    """Whether the schema takes them for tours."""
    return (
        isinstance(given, list)
        and given != []
        and all(isinstance(tour, list) for tour in given)
        and all(_is_city(city) for tour in given for city in tour)
    )


def _is_key(given: Any) -> bool:
    """Whether the schema takes it for an idempotency key."""
    return (
        isinstance(given, str) and 0 < len(given) <= 255 and given.isascii() and given.isprintable()
    )


def _is_city(given: Any) -> bool:
    return _is_number(given) and given % 1 == 0 and 0 <= given < 2**31


def _is_number(given: Any) -> bool:
    return not isinstance(given, bool) and isinstance(given, int | float)
