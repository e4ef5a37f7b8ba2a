"""Validate JSON against a pydantic model, and word each error as a refusal of this service."""

import re
from collections.abc import Collection, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, to_json

from service.errors import MOST_FAULTS, Fault, Refusal

Model = TypeVar("Model", bound=BaseModel)


def parse_json(model: type[Model], body: bytes) -> Model:
    """Return a JSON body as a model.

    Raises:
        Refusal: The body is not JSON, or does not fit the model.
    """
    try:
        return model.model_validate_json(body)
    except ValidationError as error:
        errors = error.errors(include_url=False)
        if errors[0]["type"] == "json_invalid":
            reason = errors[0]["ctx"]["error"]
            raise Refusal("malformed-json", reason=reason) from None
        errors = [_with_exact_length(model, each) for each in errors]
        raise refusal_of(errors, fields=model.model_fields.keys()) from None


def refusal_of(
    errors: Sequence[ErrorDetails], parameters: bool = False, fields: Collection[str] = ()
) -> Refusal:
    """Return pydantic's errors in a body with these fields, or in query parameters."""
    faults = [_fault(error, parameters, fields) for error in errors[:MOST_FAULTS]]
    more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
    return Refusal("invalid-request", detail=faults[0].detail + more, errors=faults)


def invalid(part: str, demand: str) -> Refusal:
    """Return the refusal of a part of a request, as matrices/0/2, that misses a demand."""
    return Refusal("invalid-request", detail=f"{part} {demand}", pointer=f"/{part}")


def too_many_cities(part: str, limit: int, actual: int) -> Refusal:
    """Return the refusal of more rows, each a city, than are allowed."""
    detail = f"{part} must have at most {limit} rows, got {actual}"
    return Refusal("too-many-cities", detail=detail, pointer=f"/{part}", limit=limit, actual=actual)


def too_many_cells(limit: int, actual: int, came: object) -> Refusal:
    """Return the refusal of a map of more cells than are allowed; `came` is shown for `actual`."""
    return Refusal("too-many-cells", came=came, pointer="/grid", limit=limit, actual=actual)


def shorten(text: str) -> str:
    """Return at most 80 characters of what came, to be shown in a sentence."""
    return text if len(text) <= 80 else f"{text[:79]}…"


def _with_exact_length(model: type[BaseModel], error: ErrorDetails) -> ErrorDetails:
    """Return the error of a list of a wrong length; where one length is right, as that demand."""
    if error["type"] not in ("too_short", "too_long"):
        return error
    schema = model.model_json_schema()
    for part in error["loc"]:
        at: Any = schema.get("items") if isinstance(part, int) else None
        schema = at or schema.get("properties", {}).get(part, {})
    if "minItems" not in schema or schema["minItems"] != schema.get("maxItems"):
        return error
    return {**error, "type": "exact_length", "ctx": {"length": schema["minItems"]}}


def _fault(error: ErrorDetails, parameters: bool, fields: Collection[str]) -> Fault:
    # FastAPI puts "query" first; brackets mark a branch of a union, which the caller never wrote.
    parts = [str(part) for part in error["loc"] if not str(part).startswith("[")]
    if parameters:
        name = shorten(".".join(parts[1:]))
        return Fault(detail=f"{name} {_demand(error)}", parameter=name)
    pointer = shorten("".join("/" + part.replace("~", "~0").replace("/", "~1") for part in parts))
    hint = _hint(error, fields)
    name = pointer.lstrip("/") or "the body"
    return Fault(detail=f"{name} {_demand(error)}{hint}", pointer=pointer)


def _hint(error: ErrorDetails, fields: Collection[str]) -> str:
    """Return the field that an unknown one may be meant for, as the end of a sentence."""
    if error["type"] != "extra_forbidden" or len(error["loc"]) != 1:
        return ""
    near = get_close_matches(shorten(str(error["loc"][0])), fields, n=1)
    return f"; did you mean {near[0]}?" if near else ""


def _demand(error: ErrorDetails) -> str:
    bounds: Mapping[str, Any] = error.get("ctx", {})
    match error["type"]:
        case "missing":
            return "is required"
        case "extra_forbidden":
            return "is not a field that this request has"
        case "exact_length":
            return f"must have {bounds['length']} items, got {len(error['input'])}"
        case "too_short":
            least = bounds["min_length"]
            items = "item" if least == 1 else "items"
            return f"must have {least} {items} or more, got {len(error['input'])}"
        case "too_long":
            return f"must have {bounds['max_length']} items or fewer, got {len(error['input'])}"
        case "greater_than_equal":
            return f"must be at least {bounds['ge']:.16g}, got {_show(error['input'])}"
        case "less_than_equal":
            return f"must be at most {bounds['le']:.16g}, got {_show(error['input'])}"
    demand = re.sub(r"^Input should be", "must be", error["msg"])
    return f"{demand}, got {_show(error['input'])}"


def _show(value: object) -> str:
    match value:
        case list():
            return f"a list of {len(value)}"
        case dict():
            return "an object"
        case int() if abs(value) >= 10**40:
            return "an integer of more than 40 digits"
        case _:
            return shorten(to_json(value, inf_nan_mode="constants").decode())
