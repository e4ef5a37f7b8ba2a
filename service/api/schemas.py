"""Make the schemas of answers, for the OpenAPI document, from their declarations."""

from collections.abc import Mapping
from dataclasses import MISSING, Field, fields
from datetime import datetime
from functools import cache, reduce
from operator import or_
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray
from paretour.described import SCHEMAS, Shape, name_of, sentence_on
from paretour.fronts import FleetObjective, StoredFront
from paretour.listing import ListedFront
from paretour.plans import FleetFront, FleetPlan, Reason
from paretour.ros.paths import Pairs
from paretour.values import ActorName, CoverageItem, Front, TourItem
from pydantic import BaseModel, create_model
from pydantic import Field as Described
from pydantic.json_schema import SkipJsonSchema

from service.api.answers import CoverageAnswer
from service.api.problem import Problem
from service.fleet.measures.table import MEASURES, Measure
from service.fleet.rules import Over, Rule
from service.front import Termination
from service.jobs.record import Status
from service.objectives import MOST_OBJECTIVES, OBJECTIVES
from service.requests.stop_fields import NamedStop
from service.requests.task import KindName

_UNIONS = (Union, UnionType)
_OF_MAPS = ("places", "uncovered")  # which only answers of fronts over maps have
_NUMBERS = {NDArray[np.float64]: float, NDArray[np.int64]: int}
# The client takes whatever later services may send.
_NARROWER: Mapping[tuple[type, str], Any] = {
    (StoredFront, "status"): Status,
    (StoredFront, "problem"): Problem | None,
    (StoredFront, "kind"): KindName,
    (StoredFront, "actor"): ActorName | None,
    (StoredFront, "terminated"): Termination | None,
    (StoredFront, "request_stops"): tuple[NamedStop, ...] | None,
    (FleetFront, "request_stops"): tuple[NamedStop, ...],
    (Front, "items"): tuple[TourItem, ...],
    (CoverageAnswer, "items"): tuple[CoverageItem, ...],
    (CoverageAnswer, "places"): Pairs,
    (FleetObjective, "over"): Over,
    (FleetObjective, "measure"): Measure | None,
    (ListedFront, "status"): Status,
    (ListedFront, "kind"): KindName,
    (Reason, "rule"): Rule,
}
_MORE: Mapping[tuple[type, str], str] = {(FleetPlan, "measures"): f": {', '.join(MEASURES)}"}


def documented(of: Any) -> Any:
    """Return the type that pydantic makes the schema of a type of answers or of members from."""
    if of in SCHEMAS:
        return _model(of)
    if of is datetime:
        return str
    origin, parts = get_origin(of), get_args(of)
    if origin in _UNIONS:
        return reduce(or_, map(documented, parts))
    if origin is Annotated:
        return _of_shape(*parts)
    if origin is tuple:
        return list[documented(parts[0])]  # type: ignore[misc]  # made at run time
    if origin is Mapping:
        return dict[str, documented(parts[1])]  # type: ignore[misc]
    return of


def _of_shape(of: Any, shape: Shape) -> Any:
    """Return the type of an array or of a list of a shape."""
    if of not in _NUMBERS:
        [size] = shape.sizes
        each: Any = documented(get_args(of)[0])
        return _list(each, size, size) if isinstance(size, int) else list[each]
    made: Any = _NUMBERS[of]
    for size in reversed(shape.sizes):
        made = _list(made, OBJECTIVES, MOST_OBJECTIVES) if size == "lengths" else list[made]
    return made


def _list(of: Any, least: int, most: int) -> Any:
    """Return the type of lists of these lengths."""
    return Annotated[list[of], Described(min_length=least, max_length=most)]


@cache
def _model(cls: Any) -> type[BaseModel]:
    """Return the model of an object."""
    hints = get_type_hints(cls, include_extras=True)
    without = ("", *(_OF_MAPS if cls is Front else ()))
    members: dict[str, Any] = {
        name: _member(cls, each, hints[each.name])
        for each in fields(cls)
        if (name := name_of(each)) not in without
    }
    return create_model(SCHEMAS[cls], __doc__=sentence_on(cls), **members)


def _member(cls: type, field: Field[Any], of: Any) -> tuple[Any, Any]:
    """Return the type of a member, and how it is described."""
    for each in reversed(cls.__mro__):
        of = _NARROWER.get((each, field.name), of)
    sentence = field.metadata.get("sentence", "") + _MORE.get((cls, field.name), "")
    has_default = field.default is not MISSING or field.default_factory is not MISSING
    if field.metadata.get("always") or not (has_default or NoneType in get_args(of)):
        return documented(of), Described(description=sentence or None)
    parts = get_args(of) if get_origin(of) in _UNIONS else (of,)
    given = [documented(part) for part in parts if part is not NoneType]
    absent: Any = SkipJsonSchema[None]  # type: ignore[misc]  # which no schema names
    return reduce(or_, [*given, absent]), Described(default=None, description=sentence or None)
