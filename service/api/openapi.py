"""Summaries and examples in the OpenAPI document: of each path a request, its answer, all refusals.

A path's summary is the first line of its docstring. Examples are kept in `reference/examples.json`:
requests and answers by operation, as "POST /front"; of each refusal what its problem document says,
and `of`, where not every operation refuses so.
"""

import json
from collections.abc import Iterator
from http import HTTPStatus
from pathlib import Path
from typing import Any

from service.errors import MEDIA_TYPE

_EXAMPLES = Path(__file__).parents[1] / "reference" / "examples.json"
_REQUEST_ID = "2348e4bd4d8a4a028a885757e2b342af"


def illustrate(document: dict[str, Any]) -> None:
    """Put summaries and examples into an OpenAPI document."""
    kept = json.loads(_EXAMPLES.read_text())
    for name, operation in _operations(document):
        summary, _, operation["description"] = operation["description"].partition("\n\n")
        operation["summary"] = summary.removesuffix(".")
        if name in kept["requests"]:
            content = operation["requestBody"]["content"]["application/json"]
            content["examples"] = {each: {"value": v} for each, v in kept["requests"][name].items()}
        for status, response in operation["responses"].items():
            content = response.get("content", {})
            if status == "200" and name in kept["answers"]:
                for each in content.values():
                    each["example"] = kept["answers"][name]
            if MEDIA_TYPE in content:
                content[MEDIA_TYPE]["examples"] = _refusals(kept["refusals"], name, int(status))


def _operations(document: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            yield f"{method.upper()} {path}", operation


def _refusals(kept: list[dict[str, Any]], name: str, status: int) -> dict[str, Any]:
    return {
        refusal["code"]: {"summary": refusal["detail"], "value": _problem(refusal)}
        for refusal in kept
        if refusal["status"] == status and name in refusal.get("of", [name])
    }


def _problem(refusal: dict[str, Any]) -> dict[str, Any]:
    members = {member: value for member, value in refusal.items() if member != "of"}
    title = HTTPStatus(refusal["status"]).phrase
    return {"type": "about:blank", "title": title, **members, "request_id": _REQUEST_ID}
