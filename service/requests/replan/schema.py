"""The JSON schemas of requests to replan a front."""

from collections.abc import Iterable
from typing import Any

from service.requests.limits import Limits, limited_schema
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.map_fields import describe_map_changes

_SHARED = "ObjectiveItem"  # each form has its own name for it, as in `front_schemas`
_OBJECTIVES = ("MatrixObjective", "PlaneObjective", "MeasuredObjective")


def replan_schemas(limits: Limits, actors: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Return the schema of a request to replan and those of its parts, by name.

    Its objectives have the kinds of `front_schemas`.
    """
    schema = limited_schema(ReplanRequest, limits, actors)
    parts = schema.pop("$defs")
    fields = schema["properties"]
    if not limits.roads:
        fields["geometry"]["enum"].remove("roads")
    kinds = [{"$ref": f"#/components/schemas/{name}"} for name in _OBJECTIVES]
    fields["objectives"] = {**fields["objectives"], "items": {"oneOf": kinds}}
    describe_map_changes(fields, limits.cells)
    for name in ("done", "remove", "tour", "add"):
        fields[name]["maxItems"] = limits.cities
    named = {name: part for name, part in parts.items() if name != _SHARED}
    return {**{name: _without_null(part) for name, part in named.items()}, "ReplanRequest": schema}


def _without_null(schema: dict[str, Any]) -> dict[str, Any]:
    """Return a schema without defaults of null, which generators misread."""
    fields = {
        name: {k: v for k, v in field.items() if k != "default" or v is not None}
        for name, field in schema["properties"].items()
    }
    return {**schema, "properties": fields}
