"""The parts of a routing engine's answers that Valhalla and OSRM have in common, checked.

An answer is bounded in bytes before it is parsed, so that parsing takes milliseconds: a parser in
a thread would hold the interpreter's lock as long.
"""

from typing import Annotated, TypeVar

import numpy as np
from pydantic import BaseModel, Field, ValidationError

from service.roads.router import Array, Unintelligible

BYTES_OF_ANSWER = 2**14  # of the longest answer, beside the bytes for each of its parts
BYTES_OF_PAIR = 64  # two numbers of up to 24 characters, and what is between them
BYTES_OF_PLACE = 2**13  # what is told of one place: the roads near it, their names
BYTES_OF_ROUTE = 2**21  # the line of a route through some twenty places
_LARGEST = 1e9  # seconds or metres: thirty years, and twenty times round the Earth

Longitude = Annotated[float, Field(ge=-180, le=180, allow_inf_nan=False)]
Latitude = Annotated[float, Field(ge=-90, le=90, allow_inf_nan=False)]
Cost = Annotated[float, Field(ge=0, le=_LARGEST, allow_inf_nan=False, strict=True)]
Rows = list[list[Cost | None]]
_Model = TypeVar("_Model", bound=BaseModel)


def read(model: type[_Model], content: bytes) -> _Model:
    """Return an answer as a model, of which other members are disregarded.

    Raises:
        Unintelligible: It is not JSON, or not of the model's form.
    """
    try:
        return model.model_validate_json(content)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False, include_context=False)[0]
        where = "/".join(map(str, first["loc"]))[:80] or "it"
        raise Unintelligible(f"{where}: {first['type']}") from None


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
