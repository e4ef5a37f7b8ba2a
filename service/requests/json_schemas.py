"""The JSON schemas of requests under the limits of a service, as components of OpenAPI documents.

Generators of clients make a type of each schema. So each form of a request to `POST /front` has a
schema with a name of its own, which lists the members that this form may have. It has no rules
about others.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from service.objectives import MOST_OF_FLEETS
from service.requests.coverage import ENDS, OF_ONE_ROBOT, CoverageRequest
from service.requests.fields import PlanFields
from service.requests.fleet import FleetRequest
from service.requests.front import FORMS, FrontRequest
from service.requests.limits import Limits, defaults
from service.requests.maps.fields import USELESS
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from service.requests.stops import ROAD_MEASURES

Schema = dict[str, Any]
JSON_FORMS = ("CoordinatesRequest", "MatricesRequest", "StopsRequest")
FILE_FORMS = ("MatricesFileRequest", "StopsFileRequest")  # beside a file of matrices
_CITIES = (*FORMS, "objectives")
_SOURCES = ("matrix", "coordinates", "from", "measure", "slices")
# A speed and traffic are options of one measure each.
_OF_A_SPEED: Schema = {"speed": {"properties": {"from": {"const": "great_circle"}}}}
_OF_TRAFFIC: Schema = {"traffic": {"properties": {"from": {"const": "road_time"}}}}
_OPTIONS = ("speed", "traffic")
_SECOND = ("second_matrix", "cost_layer", "cost_layers", "second_coordinates")
# The schemas of an objective by its source of costs; those of fleets have names of their own.
_Described = Mapping[str, tuple[str, Sequence[str]]]  # description and source, by name
_OBJECTIVES: _Described = {
    "MatrixObjective": ("An objective whose costs are a matrix.", ["matrix"]),
    "PlaneObjective": ("An objective whose costs are distances in a plane.", ["coordinates"]),
    "MeasuredObjective": ("An objective that is measured between locations.", ["from"]),
}
_FRONT_OBJECTIVES: _Described = {
    **_OBJECTIVES,
    "SlicesObjective": ("An objective with a matrix for each slice of the day.", ["slices"]),
}
_FLEET_OBJECTIVES: _Described = {
    **{f"Fleet{name}": described for name, described in _OBJECTIVES.items()},
    "PlanMeasureObjective": ("An objective that is another measure of plans.", ["measure"]),
}
_CLOCKS: _Described = {
    "MatrixClock": ("Travel times that are a matrix.", ["matrix"]),
    "PlaneClock": ("Travel times that are distances in a plane.", ["coordinates"]),
    "MeasuredClock": ("Travel times that are measured between locations.", ["from"]),
}
_IN_A_FILE: _Described = {
    "NamedObjective": ("An objective whose costs are a matrix in a file.", [])
}
# Of a member that must not be there: as false, which generators of clients do not read.
_ABSENT: Schema = {"not": {}}


def reference_to(name: str) -> dict[str, str]:
    """Return the schema that refers to a component of an OpenAPI document."""
    return {"$ref": f"#/components/schemas/{name}"}


def one_of(names: Iterable[str]) -> Schema:
    """Return the schema of a value that fits one of the components with these names."""
    return {"oneOf": [reference_to(name) for name in names]}


def front_schemas(limits: Limits, actors: Iterable[str]) -> dict[str, Schema]:
    """Return the schemas of all forms by name, with those of the stops and objectives in them."""
    whole = limited_schema(FrontRequest, limits, actors)
    parts = whole.pop("$defs")
    fields = whole["properties"]
    rows = fields["matrices"]["items"]
    rows["minItems"], rows["maxItems"] = 1, limits.most_cities("matrices")
    fields["coordinates"]["maxItems"] = fields["stops"]["maxItems"] = limits.cities
    cities = _by_index(whole)
    stops = _with(whole, objectives={**fields["objectives"], "items": one_of(_FRONT_OBJECTIVES)})
    named = reference_to("NamedObjective")
    file_stops = _with(whole, objectives={**fields["objectives"], "items": named})
    forms = [
        _form(cities, "CoordinatesRequest", "Cities in planes", ["coordinates"]),
        _form(cities, "MatricesRequest", "Cities by their costs", ["matrices"]),
        _form(stops, "StopsRequest", "Stops under named objectives", ["stops", "objectives"]),
        _form(cities, "MatricesFileRequest", "Cities by costs in a file", []),
        _form(file_stops, "StopsFileRequest", "Stops by costs in a file", ["stops", "objectives"]),
    ]
    kinds = {**_FRONT_OBJECTIVES, **_IN_A_FILE}
    objectives = _objectives(parts["DayObjectiveItem"], limits, kinds)
    traffic = ["TrafficItem"] if limits.traffic else []
    items = [parts[name] for name in ("StopItem", "SliceItem", "DepartureRange", *traffic)]
    return _by_title(*map(_without_null, items), *objectives, *map(_without_null, forms))


def _of_fleet(schema: Schema) -> Schema:
    """Return the schema of a request for a fleet, which is changed: it has fewer objectives."""
    schema["properties"]["reference_point"]["maxItems"] = MOST_OF_FLEETS
    return schema


def fleet_schemas(limits: Limits) -> dict[str, Schema]:
    """Return the schema of a request for a fleet, and of all that is in it, by name."""
    whole = _of_fleet(_limited(FleetRequest, limits))
    parts = whole.pop("$defs")
    fields = whole["properties"]
    fields["stops"]["maxItems"] = fields["shipments"]["maxItems"] = limits.fleet_stops
    fields["objectives"]["items"] = one_of(_FLEET_OBJECTIVES)
    named = fields["clock"]["anyOf"][0]["oneOf"][0]
    description = fields["clock"]["description"]
    fields["clock"] = {"anyOf": [named, one_of(_CLOCKS)], "description": description}
    items = [parts[name] for name in ("FleetStopItem", "ShipmentItem", "VehicleItem", "BreakItem")]
    objectives = _objectives(parts["FleetObjectiveItem"], limits, _FLEET_OBJECTIVES)
    clocks = _objectives(parts["ClockItem"], limits, _CLOCKS)
    return _by_title(*map(_without_null, (*items, whole)), *objectives, *clocks)


def replan_schemas(limits: Limits, actors: Iterable[str]) -> dict[str, Schema]:
    """Return the schema of a request to replan, and of what is in it, by name.

    Its objectives are those of `front_schemas`.
    """
    whole = limited_schema(ReplanRequest, limits, actors)
    parts = whole.pop("$defs")
    del parts["DayObjectiveItem"], parts["TrafficItem"]
    fields = whole["properties"]
    fields["objectives"]["items"] = one_of(_FRONT_OBJECTIVES)
    fields["grid"]["items"]["items"] = {"enum": [0, 1]}
    for name in ("blocked", "freed"):
        fields[name]["maxItems"] = limits.cells
    for name in ("done", "remove", "tour", "add"):
        fields[name]["maxItems"] = limits.cities
    return _by_title(*map(_without_null, parts.values()), whole)


def replan_fleet_schemas(limits: Limits) -> dict[str, Schema]:
    """Return the schema of a request to replan a fleet, and of what only it has, by name."""
    whole = _of_fleet(_limited(ReplanFleetRequest, limits))
    parts = whole.pop("$defs")
    for name in ("routes", "add", "remove"):
        whole["properties"][name]["maxItems"] = limits.fleet_stops
    own = [parts[name] for name in ("RouteOnTheWay", "NewFleetStop")]
    return _by_title(*map(_without_null, (*own, whole)))


def coverage_schemas(limits: Limits, actors: Iterable[str]) -> dict[str, Schema]:
    """Return the schemas of a request for a map, without and with a file of it, by name."""
    whole = _coverage_schema(limits, actors)
    _, *others = whole["allOf"]
    file = {
        **whole,
        "title": "CoverageFileRequest",
        "description": "Places on a map that is a file, and the options of their front.",
        "properties": {k: v for k, v in whole["properties"].items() if k not in USELESS},
        "required": ["cell_size"],
        "allOf": others,
    }
    return _by_title(whole, file)


def _coverage_schema(limits: Limits, actors: Iterable[str]) -> Schema:
    whole = limited_schema(CoverageRequest, limits, actors)
    schema: Schema = _inlined(whole, whole.pop("$defs"))
    fields = schema["properties"]
    most_places = limits.most_places(shared=False)
    fields["places"]["maxItems"] = most_places
    fields["grid"]["items"]["items"] = {"enum": [0, 1]}
    data = fields["occupancy_grid"]["properties"]["data"]
    data["items"] = {"type": "integer", "minimum": -1, "maximum": 100}
    data["maxItems"] = limits.cells
    robot = fields["robots"]["items"]
    for name in ("start", "end"):
        robot["properties"][name]["maximum"] = most_places - 1
    del robot["properties"]["end"]["default"]
    robot["dependentSchemas"] = {place: _absent(pose) for place, pose in ENDS}
    in_a_frame = _any_required("origin", "occupancy_grid")
    open_route = {"closed": {"const": False}}
    schema["dependentSchemas"] = {
        "robots": _absent(*OF_ONE_ROBOT),
        "over": {"required": ["robots"]},
        "start_pose": {"anyOf": in_a_frame, **_absent("start", "initial_tours")},
        "end_pose": {
            "anyOf": in_a_frame,
            "required": ["closed"],
            "properties": {**open_route, **_absent("end", "initial_tours")["properties"]},
        },
    }
    maps = [
        {"required": ["grid", "cell_size"], **_absent(*USELESS["grid"], "occupancy_grid")},
        {"required": ["occupancy_grid"], **_absent(*USELESS["occupancy_grid"], "grid")},
    ]
    robots = {"required": ["robots"], **_absent(*_SECOND)}
    schema["allOf"] = [
        {"oneOf": maps},
        {"oneOf": _any_required("places", "spacing")},
        {"oneOf": [*_any_required(*_SECOND), robots]},
    ]
    return schema


def limited_schema(model: type[PlanFields], limits: Limits, actors: Iterable[str]) -> Schema:
    """Return the JSON schema of a request under these limits, with these actors to choose from."""
    schema = _limited(model, limits)
    fields = schema["properties"]
    count, *lists = fields["preferences"]["oneOf"]
    count["maximum"] = limits.preferences
    for each in lists:
        each["maxItems"] = limits.preferences
    fields["repairs"]["maximum"] = limits.repairs
    fields["actor"]["enum"] = sorted(actors)
    for name in {"start", "end"}.intersection(fields):
        reference, _ = fields[name]["anyOf"]  # the other is null
        index, *_ = reference.get("oneOf", [reference])
        index["maximum"] = limits.cities - 1
    if "initial_tours" in fields:
        fields["initial_tours"]["maxItems"] = limits.size
    return schema


def _limited(model: type[BaseModel], limits: Limits) -> Schema:
    """Return the JSON schema of a request, with the limits that all requests have."""
    schema = model.model_json_schema(ref_template=reference_to("{model}")["$ref"])
    fields = schema["properties"]
    for name, most in (("size", limits.size), ("time_limit", limits.seconds)):
        fields[name] |= {"maximum": most, "default": defaults(limits)[name]}
    if "geometry" in fields and not limits.roads:
        fields["geometry"]["enum"].remove("roads")
    return schema


def _by_title(*schemas: Schema) -> dict[str, Schema]:
    return {schema["title"]: schema for schema in schemas}


def _with(schema: Schema, **fields: Schema) -> Schema:
    return {**schema, "properties": {**schema["properties"], **fields}}


def _without_null(schema: Schema) -> Schema:
    """Return a schema without defaults of null, which generators misread."""
    fields = {
        name: {k: v for k, v in field.items() if k != "default" or v is not None}
        for name, field in schema["properties"].items()
    }
    return {**schema, "properties": fields}


def _absent(*names: str) -> Schema:
    """Return the schema of an object that has none of these members."""
    return {"properties": dict.fromkeys(names, _ABSENT)}


def _any_required(*names: str) -> list[Schema]:
    return [{"required": [name]} for name in names]


def _inlined(schema: Any, definitions: Schema) -> Any:
    """Return a JSON schema with definitions in place of the references to them."""
    if isinstance(schema, list):
        return [_inlined(each, definitions) for each in schema]
    if not isinstance(schema, dict):
        return schema
    beside = {name: _inlined(each, definitions) for name, each in schema.items() if name != "$ref"}
    if "$ref" not in schema:
        return beside
    return {**_inlined(definitions[schema["$ref"].rsplit("/", 1)[1]], definitions), **beside}


def _by_index(schema: Schema) -> Schema:
    """Return the schema of a request whose cities have only indexes, not ids."""
    fields = schema["properties"]
    tours = fields["initial_tours"]
    place, _ = tours["items"]["items"]["oneOf"]
    tours = {**tours, "items": {**tours["items"], "items": place}}
    ends = {}
    for name in ("start", "end"):
        reference, null = fields[name]["anyOf"]
        ends[name] = {**fields[name], "anyOf": [reference["oneOf"][0], null]}
    found = _with(schema, **ends, initial_tours=tours)
    for name in ("geometry", "departure", "clock"):  # cities have no locations and no names
        del found["properties"][name]
    return found


def _form(schema: Schema, name: str, cities: str, required: Sequence[str]) -> Schema:
    return _variant(schema, name, f"{cities}, and the options of their front.", _CITIES, required)


def _objectives(schema: Schema, limits: Limits, kinds: _Described) -> list[Schema]:
    """Return the schemas of an objective of these kinds, each with a description and a source."""
    schema = _without_null(schema)
    if not limits.roads:
        measures = schema["properties"]["from"]["enum"]
        known = [measure for measure in measures if measure not in ROAD_MEASURES]
        schema = _with(schema, **{"from": {**schema["properties"]["from"], "enum": known}})
    traffic = limits.traffic and "traffic" in schema["properties"]
    options = {**_OF_A_SPEED, **(_OF_TRAFFIC if traffic else {})}
    measured = {**schema, "dependentSchemas": options}
    others = {
        "from": _SOURCES if traffic else (*_SOURCES, "traffic"),
        "measure": (*_SOURCES, *_OPTIONS, "over"),
        "slices": (*_SOURCES, *_OPTIONS, "over_the_day"),
    }
    return [
        _variant(
            measured if "from" in source else schema,
            name,
            description,
            others.get("".join(source), (*_SOURCES, *_OPTIONS)),
            source,
        )
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
    return {
        **schema,
        "title": name,
        "description": description,
        "properties": fields,
        "required": [*schema.get("required", []), *chosen],
    }
