"""The request bodies of `POST /front` and `POST /coverage` in the OpenAPI document."""

from collections.abc import Iterable
from typing import Any

from service.requests.coverage import coverage_schema
from service.requests.front_schemas import JSON_FORMS, front_schemas, one_of
from service.requests.limits import Limits, reference_to

FRONT_BODY = one_of(JSON_FORMS)
COVERAGE_BODY = reference_to("CoverageRequest")


def request_schemas(limits: Limits, actors: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Return the schemas that bodies refer to, by name, under these limits, with these actors."""
    names = list(actors)
    return {**front_schemas(limits, names), "CoverageRequest": coverage_schema(limits, names)}


def openapi_body(schema: dict[str, Any]) -> dict[str, Any]:
    """Return the entry of a body of JSON with this schema."""
    return {"required": True, "content": {"application/json": {"schema": schema}}}
