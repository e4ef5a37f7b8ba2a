"""Front requests: what they may say under given limits, and what one says."""

from collections.abc import Iterable
from typing import Any

from pydantic import ValidationError

from service.errors import Refusal
from service.requests.arrays import check_costs, loaded
from service.requests.limits import Limits, Request, defaults_within, within
from service.requests.schemas import LARGEST, FrontRequest, PlanRequest
from service.requests.validation import invalid, refused_by, too_many_cities


def request_schema(limits: Limits, actors: Iterable[str]) -> dict[str, Any]:
    """The JSON schema of a front request where these limits hold and these actors are loaded."""
    schema = plan_schema(FrontRequest, limits, actors)
    fields = schema["properties"]
    schema["oneOf"] = [{"required": ["coordinates"]}, {"required": ["matrices"]}]
    schema["dependentSchemas"] = {"matrices": {"properties": {"augment": {"const": 1}}}}
    fields["coordinates"]["maxItems"] = limits.cities
    rows = fields["matrices"]["items"]
    rows["minItems"], rows["maxItems"] = 1, limits.cities
    return schema


def plan_schema(model: type[PlanRequest], limits: Limits, actors: Iterable[str]) -> dict[str, Any]:
    """The JSON schema of a request where these limits hold and these actors are loaded."""
    schema = model.model_json_schema()
    fields = schema["properties"]
    count, angles = fields["preferences"]["oneOf"]
    count["maximum"] = angles["maxItems"] = limits.preferences
    fields["size"]["maximum"] = limits.size
    for name, default in defaults_within(limits).items():
        fields[name]["default"] = default
    fields["start"]["maximum"] = limits.cities - 1
    del fields["actor"]["default"]
    fields["actor"]["enum"] = sorted(actors)
    fields["time_limit"]["maximum"] = limits.seconds
    fields["initial_tours"]["maxItems"] = limits.size
    return schema


def parse_front_request(body: bytes, limits: Limits, matrices: bytes | None = None) -> FrontRequest:
    """The request in a body, with the matrices of a .npy file where one came with it.

    Raises:
        Refusal: it is not JSON, not a front request, over a limit, or asks for what there is not.
    """
    request = parsed(FrontRequest, body)
    if matrices is not None:
        if "matrices" in request.model_fields_set:
            raise invalid("matrices", "must come once, got them as a part as well")
        request = request.model_copy(update={"matrices": loaded(matrices, limits.cities)})
    _check_instance(request, limits)
    return within(limits, request, request.n)


def parsed(model: type[Request], body: bytes) -> Request:
    """What a body says.

    Raises:
        Refusal: it is not JSON, or says something else.
    """
    try:
        return model.model_validate_json(body)
    except ValidationError as error:
        errors = error.errors(include_url=False)
        if errors[0]["type"] == "json_invalid":
            reason = errors[0]["ctx"]["error"]
            raise Refusal("malformed-json", reason=reason) from None
        raise refused_by(errors) from None


def _check_instance(request: FrontRequest, limits: Limits) -> None:
    given = {"coordinates", "matrices"} & request.model_fields_set
    if len(given) != 1:
        came = "both" if given else "neither"
        sentence = f"either coordinates or matrices are required, got {came}"
        raise Refusal("invalid-request", detail=sentence, pointer="/coordinates")
    if request.kind == "matrices" and request.augment > 1:
        demand = "must be 1 for matrices, which cannot be turned or mirrored"
        raise invalid("augment", f"{demand}, got {request.augment}")
    if request.n > limits.cities:
        raise too_many_cities(request.kind, limits.cities, request.n)
    if request.kind == "coordinates":
        return
    for m, matrix in enumerate(request.matrices):
        check_costs(matrix, f"matrices/{m}", LARGEST)
