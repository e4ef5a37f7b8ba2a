"""What schemathesis has to know beyond the OpenAPI document."""

from typing import Any

import schemathesis


@schemathesis.hook
def before_call(context: Any, case: Any, kwargs: dict[str, Any]) -> None:  # noqa: ARG001
    """No schema can say that a start is one of the cities, nor that a tour visits each once."""
    match case.body:
        case {"coordinates": [_, *_] as rows, **others}:
            if isinstance(others.get("start"), int | float) and others["start"] >= len(rows):
                case.body["start"] = 0
            if _are_tours(others.get("initial_tours")):
                case.body["initial_tours"] = [list(range(len(rows)))]


def _are_tours(given: Any) -> bool:
    """Whether the schema takes them for tours."""
    return (
        isinstance(given, list)
        and given != []
        and all(isinstance(tour, list) for tour in given)
        and all(_is_city(city) for tour in given for city in tour)
    )


def _is_city(given: Any) -> bool:
    whole = not isinstance(given, bool) and isinstance(given, int | float) and given % 1 == 0
    return whole and 0 <= given < 2**31
