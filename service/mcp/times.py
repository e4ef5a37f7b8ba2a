"""Read the times in the members of a request that agents may write as texts, as "10:00"."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from pydantic import BaseModel
from pydantic_core.core_schema import FloatSchema

from service.amounts.read import number_in
from service.requests.fields import is_time
from service.requests.json_schemas import WithoutNull
from service.requests.null_members import NUMBER_OR_TEXT, Shape, shape_of


class WithTimes(WithoutNull):
    """Make JSON schemas in which times may also be texts."""

    def float_schema(self, schema: FloatSchema) -> dict[str, Any]:
        """Return the schema of a number, which may be a time."""
        found = super().float_schema(schema)
        return {**found, "type": NUMBER_OR_TEXT} if is_time(schema) else found


def with_times(
    members: Mapping[str, Any], unit: str | None, *forms: type[BaseModel]
) -> dict[str, Any]:
    """Return the members of some forms with numbers, in a unit, for the times that are texts.

    Raises:
        ValueError: As of `number_in`.
    """
    return _read(members, _shape_of(*forms), unit)


@cache
def _shape_of(*forms: type[BaseModel]) -> Shape | None:
    schemas = [form.model_json_schema(schema_generator=WithTimes) for form in forms]
    parts = {name: part for schema in schemas for name, part in schema.get("$defs", {}).items()}
    return shape_of(schemas, parts)


def _read(value: Any, shape: Shape | None, unit: str | None) -> Any:
    if shape is None:
        return value
    if isinstance(value, str):
        return number_in(value, unit) if shape.is_amount else value
    if isinstance(value, list):
        return [_read(each, shape.items, unit) for each in value]
    if isinstance(value, Mapping):
        return {name: _read(each, shape.members.get(name), unit) for name, each in value.items()}
    return value


def clock_unit(request: Mapping[str, Any]) -> str | None:
    """Return the unit of the clock in a request for a fleet that is not checked yet."""
    clock, objectives = request.get("clock"), request.get("objectives")
    named = [each for each in objectives or () if isinstance(each, Mapping)]
    found = next((each for each in named if each.get("name") == clock), clock)
    if not isinstance(found, Mapping):
        return None
    measured = "s" if found.get("from") == "road_time" or found.get("speed") is not None else None
    unit = found.get("unit") or measured
    return unit if isinstance(unit, str) else None
