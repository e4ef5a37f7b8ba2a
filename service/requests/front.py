"""Front requests: what they may say under given limits, and what one says."""

from collections.abc import Iterable
from typing import Any, TypeVar

from pydantic import ValidationError

from service.errors import Fault, Refusal
from service.requests.arrays import check_costs, invalid, loaded, too_many_cities
from service.requests.schemas import LARGEST, FrontRequest, Limits, PlanRequest
from service.requests.validation import refused_by

Request = TypeVar("Request", bound=PlanRequest)


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
    for name, default in _defaults_within(limits).items():
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
            raise Refusal(400, "malformed-json", f"the body must be JSON: {reason}") from None
        raise refused_by(errors) from None


def within(limits: Limits, request: Request, n: int) -> Request:
    """The request, about n cities, with defaults within the limits.

    Raises:
        Refusal: it is over a limit.
    """
    _check_limits(request, n, limits)
    defaults = _defaults_within(limits).items()
    asked = request.model_fields_set
    lowered = {k: v for k, v in defaults if k not in asked and v < getattr(request, k)}
    return request.model_copy(update=lowered) if lowered else request


def _defaults_within(limits: Limits) -> dict[str, float]:
    """The defaults that a limit may lower: who asks for nothing is never over a limit."""
    most = {
        "preferences": limits.preferences,
        "size": limits.size,
        "time_limit": limits.seconds,
    }
    fields = FrontRequest.model_fields
    return {name: min(fields[name].default, limit) for name, limit in most.items()}


def _check_instance(request: FrontRequest, limits: Limits) -> None:
    given = {"coordinates", "matrices"} & request.model_fields_set
    if len(given) != 1:
        came = "both" if given else "neither"
        sentence = f"either coordinates or matrices are required, got {came}"
        fault = Fault(pointer="/coordinates", detail=sentence)
        raise Refusal(422, "invalid-request", sentence, errors=[fault])
    if request.kind == "matrices" and request.augment > 1:
        demand = "must be 1 for matrices, which cannot be turned or mirrored"
        raise invalid("augment", f"{demand}, got {request.augment}")
    if request.n > limits.cities:
        raise too_many_cities(request.kind, limits.cities, request.n)
    if request.kind == "coordinates":
        return
    for m, matrix in enumerate(request.matrices):
        check_costs(matrix, f"matrices/{m}", LARGEST)


def _check_limits(request: PlanRequest, n: int, limits: Limits) -> None:
    if request.start >= n:
        raise invalid("start", f"must be a city, 0 to {n - 1}, got {request.start}")
    if "preferences" in request.model_fields_set:
        looked = request.preferences
        k = looked if isinstance(looked, int) else len(looked)
        _check_most("preferences", limits.preferences, k)
    if "size" in request.model_fields_set:
        _check_most("size", limits.size, request.size)
    if "time_limit" in request.model_fields_set:
        _check_most("time_limit", limits.seconds, request.time_limit)
    _check_most("initial_tours", limits.size, len(request.initial_tours))
    for index, tour in enumerate(request.initial_tours):
        if sorted(tour) != list(range(n)):
            demand = f"must visit each city, 0 to {n - 1}, once"
            raise invalid(f"initial_tours/{index}", demand)


def _check_most(name: str, limit: float, actual: float) -> None:
    if actual > limit:
        fault = Fault(
            pointer=f"/{name}", detail=f"{name} must be at most {limit:g}, got {actual:g}"
        )
        raise Refusal(422, "over-limit", fault.detail, errors=[fault], limit=limit, actual=actual)
