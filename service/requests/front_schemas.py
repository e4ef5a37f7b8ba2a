"""The JSON schemas of requests to `POST /front`: one for each form, with a name of its own.

Generators of clients make a type of each. So the schema of a form lists the members that it may
have, and has no rules about others.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from service.requests.front import FORMS, FrontRequest
from service.requests.limits import Limits, limited_schema, reference_to
from service.requests.stops import ROAD_MEASURES

Schema = dict[str, Any]
JSON_FORMS = ("CoordinatesRequest", "MatricesRequest", "StopsRequest")
FILE_FORMS = ("MatricesFileRequest", "StopsFileRequest")  # beside a file of matrices
_CITIES = (*FORMS, "objectives")
_SOURCES = ("matrix", "coordinates", "from")
_KINDS = {
    "MatrixObjective": ("An objective whose costs are a matrix.", ["matrix"]),
    "PlaneObjective": ("An objective whose costs are distances in a plane.", ["coordinates"]),
    "MeasuredObjective": ("An objective that is measured between locations.", ["from"]),
    "NamedObjective": ("An objective whose costs are a matrix in a file.", []),
}


def front_schemas(limits: Limits, actors: Iterable[str]) -> dict[str, Schema]:
    """Return the schemas of all forms by name, with those of the stops and objectives in them."""
    whole = limited_schema(FrontRequest, limits, actors)
    parts = whole.pop("$defs")
    _limit_cities(whole["properties"], limits)
    if not limits.roads:
        whole["properties"]["geometry"]["enum"].remove("roads")
    cities = _by_index(whole)
    stops = _with_objectives(whole, ["MatrixObjective", "PlaneObjective", "MeasuredObjective"])
    file_stops = _with_objectives(whole, ["NamedObjective"])
    forms = [
        _form(cities, "CoordinatesRequest", "Cities in two planes", ["coordinates"]),
        _form(cities, "MatricesRequest", "Cities by their costs", ["matrices"]),
        _form(stops, "StopsRequest", "Stops under two objectives", ["stops", "objectives"]),
        _form(cities, "MatricesFileRequest", "Cities by costs in a file", []),
        _form(file_stops, "StopsFileRequest", "Stops by costs in a file", ["stops", "objectives"]),
    ]
    stop, objective = (without_null(parts[name]) for name in ("StopItem", "ObjectiveItem"))
    named = [stop, *objective_variants(objective, limits, _KINDS), *forms]
    return {schema["title"]: schema for schema in named}


def one_of(names: Sequence[str]) -> Schema:
    """Return the schema of a value that fits one of the components with these names."""
    return {"oneOf": [reference_to(name) for name in names]}


def without_null(schema: Schema) -> Schema:
    """Return a schema without defaults of null, which generators misread."""
    fields = {
        name: {k: v for k, v in field.items() if k != "default" or v is not None}
        for name, field in schema["properties"].items()
    }
    return {**schema, "properties": fields}


def _limit_cities(fields: Schema, limits: Limits) -> None:
    rows = fields["matrices"]["items"]
    rows["minItems"], rows["maxItems"] = 1, limits.most_cities("matrices")
    fields["coordinates"]["maxItems"] = fields["stops"]["maxItems"] = limits.cities


def _by_index(schema: Schema) -> Schema:
    """Return the schema of a request whose cities have only indexes, not ids."""
    fields = schema["properties"]
    tours = fields["initial_tours"]
    place, _ = tours["items"]["items"]["oneOf"]
    tours = {**tours, "items": {**tours["items"], "items": place}}
    start, end = (_by_index_or_null(fields[name]) for name in ("start", "end"))
    found = _with(schema, start=start, end=end, initial_tours=tours)
    del found["properties"]["geometry"]  # cities without stops have no locations
    return found


def _by_index_or_null(field: Schema) -> Schema:
    reference, null = field["anyOf"]
    index, _ = reference["oneOf"]
    return {**field, "anyOf": [index, null]}


def _with_objectives(schema: Schema, names: Sequence[str]) -> Schema:
    """Return the schema of a request whose objectives are of the kinds with these names."""
    items = one_of(names) if len(names) > 1 else reference_to(names[0])
    return _with(schema, objectives={**schema["properties"]["objectives"], "items": items})


def _with(schema: Schema, **fields: Schema) -> Schema:
    return {**schema, "properties": {**schema["properties"], **fields}}


def _form(schema: Schema, name: str, cities: str, required: Sequence[str]) -> Schema:
    description = f"{cities}, and the options of their front."
    return _variant(schema, name, description, _CITIES, required)


def objective_variants(
    schema: Schema, limits: Limits, kinds: Mapping[str, tuple[str, Sequence[str]]]
) -> list[Schema]:
    """Return the schemas of an objective of these kinds, each with a description and a source."""
    if not limits.roads:
        measures = schema["properties"]["from"]["enum"]
        known = [measure for measure in measures if measure not in ROAD_MEASURES]
        schema = _with(schema, **{"from": {**schema["properties"]["from"], "enum": known}})
    return [
        _variant(schema, name, description, _SOURCES, source)
        for name, (description, source) in kinds.items()
    ]


def _variant(
    schema: Schema, name: str, description: str, choices: Sequence[str], chosen: Sequence[str]
) -> Schema:
    """Return a schema that requires the chosen members of some choices, and drops the others."""
    fields = {
        name: {k: v for k, v in field.items() if name not in chosen or k != "default"}
        for name, field in schema["properties"].items()
        if name in chosen or name not in choices
    }
    required = [*schema.get("required", []), *chosen]
    return {
        **schema,
        "title": name,
        "description": description,
        "properties": fields,
        "required": required,
    }
