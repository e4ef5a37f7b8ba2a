"""The JSON schemas of requests under the limits of a service, as components of OpenAPI documents.

Each is the schema of its form, and of all that is in it. Generators of clients make a type of each.
"""

from collections.abc import Iterable, Mapping, Sequence
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
from service.requests.stop_fields import SOURCES
from service.requests.stops import ROAD_MEASURES

Schema = dict[str, Any]
RULES = ("allOf", "dependentSchemas")  # the parts of a schema about which members go together
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


def form_schemas(limits: Limits, actors: Iterable[str]) -> dict[str, Schema]:
    """Return the schemas of all requests, and of all that is in them, by name.

    Those of fronts and maps are there without and with a file.
    """
    names = list(actors)
    found: dict[str, Schema] = {}
    for model, most_items in _most_items(limits).items():
        schemas = limited_schemas(model, limits, names)
        fields = schemas[model.__name__]["properties"]
        for name, most in most_items.items():
            fields[name]["maxItems"] = most
        if "grid" in fields:
            fields["grid"]["items"]["items"] = {"enum": [0, 1]}
        if model is FrontRequest:
            _complete_fronts(schemas, limits)
        elif model is CoverageRequest:
            _complete_maps(schemas, limits)
        found |= schemas
    return found


def _most_items(limits: Limits) -> Mapping[type[BaseModel], Mapping[str, int]]:
    """Return how long lists in each request may be, in the order of the OpenAPI document."""
    of_fleet = dict.fromkeys(("routes", "add", "remove"), limits.fleet_stops)
    return {
        FrontRequest: dict.fromkeys(("coordinates", "stops"), limits.cities),
        CoverageRequest: {"places": limits.most_places(shared=False)},
        ReplanRequest: {
            **dict.fromkeys(("blocked", "freed"), limits.cells),
            **dict.fromkeys(("done", "remove", "tour", "add"), limits.cities),
        },
        ReplanFleetRequest: of_fleet,
        OffersRequest: of_fleet,
        FleetRequest: dict.fromkeys(("stops", "shipments"), limits.fleet_stops),
    }


def _complete_fronts(schemas: dict[str, Schema], limits: Limits) -> None:
    """Complete the schemas of a request for a front, and add those beside a file of matrices."""
    whole, objective = schemas["FrontRequest"], schemas["DayObjectiveItem"]
    rows = whole["properties"]["matrices"]["items"]
    rows["minItems"], rows["maxItems"] = 1, limits.most_cities("matrices")
    file = _beside_a_file(
        whole,
        "FrontFileRequest",
        "Cities or stops whose costs are in a file, and the options of their front.",
        ("coordinates", "matrices"),
    )
    named = _beside_a_file(
        objective,
        "FileObjectiveItem",
        "An objective whose costs are in a file.",
        (*SOURCES, "speed", "traffic"),
    )
    objectives = {**whole["properties"]["objectives"], "items": reference_to(named["title"])}
    file["properties"]["objectives"] = objectives
    schemas |= {each["title"]: each for each in (file, named)}


def _complete_maps(schemas: dict[str, Schema], limits: Limits) -> None:
    """Complete the schemas of a request for a map, and add the one beside a file of it."""
    whole, robot = schemas["CoverageRequest"], schemas["RobotItem"]
    data = schemas["OccupancyGrid"]["properties"]["data"]
    data["items"] = {"type": "integer", "minimum": -1, "maximum": 100}
    data["maxItems"] = limits.cells
    for name in ("start", "end"):
        robot["properties"][name]["maximum"] = limits.most_places(shared=False) - 1
    robot["dependentSchemas"] = {place: _absent(pose) for place, pose in ENDS}
    _add_rules_of_maps(whole)
    description = "Places on a map that is a file, and the options of their front."
    file = _beside_a_file(whole, "CoverageFileRequest", description, tuple(USELESS))
    schemas[file["title"]] = file | {"required": ["cell_size"], "allOf": whole["allOf"][1:]}


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
    model: type[BaseModel], limits: Limits, actors: Sequence[str]
) -> dict[str, Schema]:
    """Return the schemas of a request and of its parts, with the limits on its numbers.

    Args:
        actors: The names of the actors to choose from.
    """
    template = reference_to("{model}")["$ref"]
    whole = model.model_json_schema(ref_template=template, schema_generator=WithoutNull)
    schemas: dict[str, Schema] = {**whole.pop("$defs", {}), model.__name__: whole}
    fields = whole["properties"]
    for name, most in (("size", limits.size), ("time_limit", limits.seconds)):
        if name in fields:
            fields[name] |= {"maximum": most, "default": defaults(limits)[name]}
    if issubclass(model, PlanFields):
        _limit_tours(fields, limits, actors)
    if "geometry" in fields and not limits.roads:
        fields["geometry"]["enum"].remove("roads")
    if not limits.traffic:
        _drop_traffic(schemas)
    for schema in schemas.values():
        source = schema["properties"].get("from", {})
        if "enum" in source and not limits.roads:
            source["enum"] = [each for each in source["enum"] if each not in ROAD_MEASURES]
    return schemas


def _limit_tours(fields: dict[str, Schema], limits: Limits, actors: Sequence[str]) -> None:
    """Limit the numbers in the fields of a request for a front of tours."""
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


def _drop_traffic(schemas: dict[str, Schema]) -> None:
    """Leave traffic out of all schemas."""
    schemas.pop("TrafficItem", None)
    for schema in schemas.values():
        for part in ("properties", "dependentSchemas"):
            schema.get(part, {}).pop("traffic", None)


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
