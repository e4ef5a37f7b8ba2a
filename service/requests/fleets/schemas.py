"""The JSON schemas of requests to `POST /fleet`, each with a name of its own."""

from typing import Any

from service.requests.fleets.request import FleetRequest
from service.requests.front_schemas import objective_variants, one_of, without_null
from service.requests.limits import Limits, defaults, reference_to

Schema = dict[str, Any]
_KINDS = {
    "FleetMatrixObjective": ("An objective whose costs are a matrix.", ["matrix"]),
    "FleetPlaneObjective": ("An objective whose costs are distances in a plane.", ["coordinates"]),
    "FleetMeasuredObjective": ("An objective that is measured between locations.", ["from"]),
}


def fleet_schemas(limits: Limits) -> dict[str, Schema]:
    """Return the schema of a request under these limits, and of all that is in it, by name.

    References in them are to components of an OpenAPI document.
    """
    whole = FleetRequest.model_json_schema(ref_template=reference_to("{model}")["$ref"])
    parts = whole.pop("$defs")
    fields = whole["properties"]
    fields["stops"]["maxItems"] = fields["shipments"]["maxItems"] = limits.fleet_stops
    fields["size"]["maximum"], fields["time_limit"]["maximum"] = limits.size, limits.seconds
    for name in ("size", "time_limit"):
        fields[name]["default"] = defaults(limits)[name]
    if not limits.roads:
        fields["geometry"]["enum"].remove("roads")
    fields["objectives"]["items"] = one_of(list(_KINDS))
    items = [without_null(parts[name]) for name in ("FleetStopItem", "ShipmentItem", "VehicleItem")]
    objective = without_null(parts["FleetObjectiveItem"])
    named = [*items, *objective_variants(objective, limits, _KINDS), without_null(whole)]
    return {schema["title"]: schema for schema in named}
