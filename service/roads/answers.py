"""Check what the answers of Valhalla and OSRM have in common: tables, places and errors.

The bytes of an answer are limited before it is parsed, so that parsing takes milliseconds. A
thread would not help: a parser holds the interpreter's lock while it runs.
"""

import re
from typing import Annotated, TypeVar

import numpy as np
from pydantic import BaseModel, Field, ValidationError
from pydantic_core import ErrorDetails, to_json

from service.roads.router import Array, Unintelligible

BYTES_OF_ANSWER = 2**14  # of the longest answer, in addition to the bytes for each of its parts
BYTES_OF_PAIR = 64  # two numbers of up to 24 characters, with separators
BYTES_OF_PLACE = 2**13  # the answer about one place: the roads near it, their names
BYTES_OF_ROUTE = 2**21  # the line of a route through some twenty places
_LARGEST = 1e9  # seconds or metres: thirty years, and twenty times round the Earth

Longitude = Annotated[float, Field(ge=-180, le=180, allow_inf_nan=False)]
Latitude = Annotated[float, Field(ge=-90, le=90, allow_inf_nan=False)]
Cost = Annotated[float, Field(ge=0, le=_LARGEST, allow_inf_nan=False, strict=True)]
Rows = list[list[Cost | None]]
_Model = TypeVar("_Model", bound=BaseModel)


def read(model: type[_Model], content: bytes) -> _Model:
    """Return an answer as a model; other members are ignored.

    Raises:
        Unintelligible: It is not JSON, or not of the model's form.
    """
    try:
        return model.model_validate_json(content)
    except ValidationError as error:
        raise Unintelligible(_sentence(error.errors(include_url=False)[0])) from None


def _sentence(error: ErrorDetails) -> str:
    """Return how an answer differs from the documentation; never quote a place or a name."""
    where = "/".join(map(str, error["loc"]))[:80] or "it"
    if error["type"] == "json_invalid":
        return f"it must be JSON: {error['ctx']['error']}"
    if error["type"] == "missing":
        return f"{where} is missing"
    # Pydantic's own: Input should be a valid list, String should match pattern and so on.
    demand = re.sub(r"^\w+ should ", "must ", error["msg"])
    return f"{where} {demand}, got {_show(error['input'])}"


def _show(value: object) -> str:
    match value:
        case dict():
            return "an object"
        case list():
            return f"a list of {len(value)}"
        case str():
            return f"a text of {len(value)}"
        case _:
            return to_json(value, inf_nan_mode="constants").decode()[:40]


def costs_of(seconds: Rows, metres: Rows, shape: tuple[int, int]) -> Array:
    """Return two tables as one array, shape (2, sources, targets), infinite where there is none.

    Raises:
        Unintelligible: A table is not of the shape, or only one of them has a way.
    """
    for rows in (seconds, metres):
        if len(rows) != shape[0] or any(len(row) != shape[1] for row in rows):
            raise Unintelligible(f"a table must have {shape[0]} rows of {shape[1]} numbers")
    costs = np.array([seconds, metres], dtype=np.float64).reshape(2, *shape)
    if (np.isnan(costs[0]) != np.isnan(costs[1])).any():
        raise Unintelligible("a way must have both a time and a distance")
    costs[np.isnan(costs)] = np.inf
    return costs
