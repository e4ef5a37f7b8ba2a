"""The JSON schemas of requests under the limits of a service, as components of OpenAPI documents.

Each is the schema of its form, and of all that is in it. Generators of clients make a type of each.
"""

from collections.abc import Iterable, Sequence
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema
from pydantic_core.core_schema import WithDefaultSchema

from service.requests.coverage import ENDS, OF_ONE_ROBOT, CoverageRequest
from service.requests.fields import ABSENT, PlanFields
from service.requests.fleet import FleetRequest
from service.requests.front import FrontRequest
from service.requests.limits import Limits, defaults
from service.requests.maps.fields import USELESS
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from service.requests.replan.offers import OffersRequest
from service.requests.stops import ROAD_MEASURES

Schema = dict[str, Any]
RULES = ("allOf", "dependentSchemas")  # the parts of a schema about which members go together
_SOURCES = ("matrix", "coordinates", "from", "slices", "breakpoints", "days", "speed", "traffic")
_SECOND = ("second_matrix", "cost_layer", "cost_layers", "second_coordinates")


class WithoutNull(GenerateJsonSchema):
    """Make JSON schemas without defaults of null, which generators of clients misread."""

    def default_schema(self, schema: WithDefaultSchema) -> Schema:
        """Return the schema of a field that has a default."""
        found = super().default_schema(schema)
        return {key: value for key, value in found.items() if (key, value) != ("default", None)}


def reference_to(name: str) -> dict[str, str]:
    """Return the schema that refers to a component of an OpenAPI document."""
    return {"$ref": f"#/components/schemas/{name}"}


def front_schemas(limits: Limits, actors: Iterable[str]) -> dict[str, Schema]:
    """Return the schemas of a request for a front, without and with a file of matrices, by name."""
    schemas = limited_schemas(FrontRequest, limits, actors)
    whole, objective = schemas["FrontRequest"], schemas["DayObjectiveItem"]
    rows = whole["properties"]["matrices"]["items"]
    rows["minItems"], rows["maxItems"] = 1, limits.most_cities("matrices")
    _at_most(limits.cities, whole, "coordinates", "stops")
    named = _beside_a_file(
        objective, "FileObjectiveItem", "An objective whose costs are in a file.", _SOURCES
    )
    file = _beside_a_file(
        whole,
        "FrontFileRequest",
        "Cities or stops whose costs are in a file, and the options of their front.",
        ("coordinates", "matrices"),
    )
    objectives = {**whole["properties"]["objectives"], "items": reference_to(named["title"])}
    file["properties"]["objectives"] = objectives
    return {**schemas, file["title"]: file, named["title"]: named}


def fleet_schemas(limits: Limits) -> dict[str, Schema]:
    """Return the schema of a request for a fleet, and of all that is in it, by name."""
    schemas = _limited(FleetRequest, limits)
    whole = schemas["FleetRequest"]
    _at_most(limits.fleet_stops, whole, "stops", "shipments")
    return schemas


def replan_schemas(limits: Limits, actors: Iterable[str]) -> dict[str, Schema]:
    """Return the schema of a request to replan, and of all that is in it, by name."""
    schemas = limited_schemas(ReplanRequest, limits, actors)
    whole = schemas["ReplanRequest"]
    whole["properties"]["grid"]["items"]["items"] = {"enum": [0, 1]}
    _at_most(limits.cells, whole, "blocked", "freed")
    _at_most(limits.cities, whole, "done", "remove", "tour", "add")
    return schemas


def replan_fleet_schemas(limits: Limits) -> dict[str, Schema]:
    """Return the schema of a request to replan a fleet, and of all that is in it, by name."""
    schemas = _limited(ReplanFleetRequest, limits)
    whole = schemas["ReplanFleetRequest"]
    _at_most(limits.fleet_stops, whole, "routes", "add", "remove")
    return schemas


def offers_schemas(limits: Limits) -> dict[str, Schema]:
    """Return the schema of a request for offers, and of all that is in it, by name."""
    schemas = _limited(OffersRequest, limits)
    _at_most(limits.fleet_stops, schemas["OffersRequest"], "routes", "add", "remove")
    return schemas


def coverage_schemas(limits: Limits, actors: Iterable[str]) -> dict[str, Schema]:
    """Return the schemas of a request for a map, without and with a file of it, by name."""
    schemas = limited_schemas(CoverageRequest, limits, actors)
    whole, robot = schemas["CoverageRequest"], schemas["RobotItem"]
    most_places = limits.most_places(shared=False)
    _at_most(most_places, whole, "places")
    whole["properties"]["grid"]["items"]["items"] = {"enum": [0, 1]}
    data = schemas["OccupancyGrid"]["properties"]["data"]
    data["items"] = {"type": "integer", "minimum": -1, "maximum": 100}
    data["maxItems"] = limits.cells
    for name in ("start", "end"):
        robot["properties"][name]["maximum"] = most_places - 1
    robot["dependentSchemas"] = {place: _absent(pose) for place, pose in ENDS}
    _add_rules_of_maps(whole)
    description = "Places on a map that is a file, and the options of their front."
    file = _beside_a_file(whole, "CoverageFileRequest", description, tuple(USELESS))
    file |= {"required": ["cell_size"], "allOf": whole["allOf"][1:]}
    return {**schemas, file["title"]: file}


def _add_rules_of_maps(schema: Schema) -> None:
    """Add to the schema of a request for a map which members go together."""
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


def limited_schemas(
    model: type[PlanFields], limits: Limits, actors: Iterable[str]
) -> dict[str, Schema]:
    """Return the schemas of a request under these limits, with these actors to choose from."""
    schemas = _limited(model, limits)
    fields = schemas[model.__name__]["properties"]
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
    return schemas


def _limited(model: type[BaseModel], limits: Limits) -> dict[str, Schema]:
    """Return the schemas of a request and of its parts, with the limits that all requests have."""
    template = reference_to("{model}")["$ref"]
    whole = model.model_json_schema(ref_template=template, schema_generator=WithoutNull)
    schemas: dict[str, Schema] = {**whole.pop("$defs", {}), model.__name__: whole}
    fields = whole["properties"]
    for name, most in (("size", limits.size), ("time_limit", limits.seconds)):
        if name in fields:
            fields[name] |= {"maximum": most, "default": defaults(limits)[name]}
    if "geometry" in fields and not limits.roads:
        fields["geometry"]["enum"].remove("roads")
    if "TrafficItem" in schemas and not limits.traffic:
        del schemas["TrafficItem"]
        _drop(schemas, "traffic")
    for schema in schemas.values():
        source = schema["properties"].get("from", {})
        if "enum" in source and not limits.roads:
            source["enum"] = [each for each in source["enum"] if each not in ROAD_MEASURES]
    return schemas


def _drop(schemas: dict[str, Schema], member: str) -> None:
    """Leave a member out of all schemas that have it."""
    for schema in schemas.values():
        for part in ("properties", "dependentSchemas"):
            schema.get(part, {}).pop(member, None)


def _at_most(most: int, schema: Schema, *names: str) -> None:
    """Limit the length of lists in a schema."""
    for name in names:
        schema["properties"][name]["maxItems"] = most


def _beside_a_file(schema: Schema, name: str, description: str, in_file: Sequence[str]) -> Schema:
    """Return a schema without the members that come as a file, and without a choice of them."""
    return {
        **{key: value for key, value in schema.items() if key != "allOf"},
        "title": name,
        "description": description,
        "properties": {k: v for k, v in schema["properties"].items() if k not in in_file},
    }


def _absent(*names: str) -> Schema:
    """Return the schema of an object that has none of these members."""
    return {"properties": dict.fromkeys(names, ABSENT)}


def _any_required(*names: str) -> list[Schema]:
    return [{"required": [name]} for name in names]
