"""The request bodies of the operations that plan, in the OpenAPI document.

Each is JSON. For fronts and coverage it may also be multipart/form-data with a part `request`,
which is JSON, and a file.
"""

from collections.abc import Iterable
from typing import Any

from service.requests.json_schemas import form_schemas, reference_to
from service.requests.limits import Limits

Schema = dict[str, Any]


def request_schemas(limits: Limits, actors: Iterable[str]) -> dict[str, Schema]:
    """Return the schemas that bodies refer to, by name, for these limits and actors."""
    file = "a .npy file of shape (2, n, n), as numpy.save writes it"
    image = "a PNG or PGM file of the map, dark where there is an obstacle"
    return {
        **form_schemas(limits, actors),
        "FrontForm": _form_schema(reference_to("FrontFileRequest"), "matrices", file),
        "CoverageForm": _form_schema(reference_to("CoverageFileRequest"), "map", image),
    }


def _body(request: Schema, form: str | None = None) -> Schema:
    """Return the entry of a body with one schema as JSON and, maybe, another as a form."""
    content: Schema = {_JSON: {"schema": request}}
    if form is not None:
        encoding = {"request": {"contentType": _JSON}}
        content["multipart/form-data"] = {"schema": reference_to(form), "encoding": encoding}
    return {"required": True, "content": content}


def _form_schema(request: Schema, file: str, description: str) -> Schema:
    content = {"type": "string", "format": "binary", "description": description}
    return {
        "type": "object",
        "description": "A request in JSON, and a file beside it.",
        "properties": {"request": request, file: content},
        "required": ["request", file],
        "additionalProperties": False,
    }


_JSON = "application/json"
FRONT_BODY = _body(reference_to("FrontRequest"), "FrontForm")
REPLAN_BODY = _body({"anyOf": [reference_to("ReplanRequest"), reference_to("ReplanFleetRequest")]})
OFFERS_BODY = _body(reference_to("OffersRequest"))
COVERAGE_BODY = _body(reference_to("CoverageRequest"), "CoverageForm")
FLEET_BODY = _body(reference_to("FleetRequest"))
