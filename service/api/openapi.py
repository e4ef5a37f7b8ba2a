"""The OpenAPI document: FastAPI's, with problem documents, headers, summaries and examples.

An operation's summary is the first line of its docstring. Examples are in
`service/reference/examples.json`: requests and answers by operation, such as "POST /front"; and for
each code of a refusal the values for its sentence, under the code, or under "code of POST /front"
where one operation needs an example of its own.
"""

import json
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from service.api.geojson.answers import points_text
from service.api.problem import Problem
from service.api.request_headers import GEOJSON, TEXT
from service.api.response_headers import HEADERS, add_headers
from service.api.responses import PROBLEM_JSON
from service.errors import PROBLEMS, Fault, Refusal

_EXAMPLES = Path(__file__).parents[1] / "reference" / "examples.json"
_DESCRIPTION = """\
Plan tours under two to four objectives at once. The answer is a Pareto front: the tours that no
other tour beats in every objective.

- [The guide](guide/) explains everything by question; `/llms.txt` lists its pages for programs.
- Every error is `application/problem+json`. Its `code` is stable, and its `type` leads to where
  [the guide explains it](guide/errors).
- If the operator has set keys, send one as `Authorization: Bearer KEY`. `RateLimit` says how many
  more requests you may make.
"""
_REQUEST_ID = "2348e4bd4d8a4a028a885757e2b342af"


def complete(document: dict[str, Any], schemas: Mapping[str, Any]) -> None:
    """Complete FastAPI's document with what only the service knows.

    Args:
        schemas: The schemas that request bodies refer to, by name.
    """
    document["info"]["description"] = _DESCRIPTION
    components = document["components"]
    components["schemas"].update(schemas)
    components["schemas"]["Problem"] = _problem_schema()
    components["securitySchemes"] = {"key": {"type": "http", "scheme": "bearer"}}
    document["security"] = [{}, {"key": []}]  # a key is needed if the settings have any
    _remove_default_refusals(document)
    _add_examples(document)
    components["headers"] = HEADERS
    for _, operation in _operations(document):
        add_headers(operation)


def example_refusal(code: str, operation: str = "") -> Refusal:
    """Return the example of a refusal, for an operation such as "POST /front" or for all."""
    refusals = _examples()["refusals"]
    fields = refusals.get(f"{code} of {operation}", refusals.get(code, {}))
    return Refusal(
        code, **{**fields, "errors": [Fault(**each) for each in fields.get("errors", ())]}
    )


@cache
def _examples() -> dict[str, Any]:
    return json.loads(_EXAMPLES.read_text(encoding="utf-8"))


def _problem_schema() -> dict[str, Any]:
    schema = Problem.model_json_schema(ref_template="#/components/schemas/{model}")
    schema["properties"]["errors"] = {"type": "array", "items": schema.pop("$defs")["FaultItem"]}
    return schema


def _remove_default_refusals(document: dict[str, Any]) -> None:
    """Remove FastAPI's own refusals of wrong parameters: the service never sends them."""
    for name in ("HTTPValidationError", "ValidationError"):
        document["components"]["schemas"].pop(name, None)
    for _, operation in _operations(document):
        if "HTTPValidationError" in str(operation["responses"].get("422")):
            del operation["responses"]["422"]


def _operations(document: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the name of each operation and webhook, such as "POST /front", and its entry."""
    for path, methods in (document["paths"] | document["webhooks"]).items():
        for method, operation in methods.items():
            yield f"{method.upper()} {path}", operation


def _add_examples(document: dict[str, Any]) -> None:
    examples = _examples()
    for name, operation in _operations(document):
        summary, _, operation["description"] = operation["description"].partition("\n\n")
        operation["summary"] = summary.removesuffix(".")
        if requests := examples["requests"].get(name):
            content = operation["requestBody"]["content"]["application/json"]
            content["examples"] = {title: {"value": value} for title, value in requests.items()}
        for status, response in operation["responses"].items():
            content = response.get("content", {})
            if status == "200" and name in examples["answers"]:
                for form, media in content.items():
                    media |= _example(form, examples["answers"][name])
            if PROBLEM_JSON in content:
                content[PROBLEM_JSON]["examples"] = _refusals(name, int(status))


def _example(form: str, answer: Any) -> dict[str, Any]:
    """Return the member `example` of an answer in a form; GeoJSON has its own."""
    if form == GEOJSON:
        return {}
    if form == TEXT and isinstance(answer, Mapping):
        lengths = [each["lengths"] for each in answer["front"]]
        return {"example": points_text(answer.get("objectives", ()), lengths)}
    return {"example": answer}


def _refusals(operation: str, status: int) -> dict[str, Any]:
    """Return an example of each refusal of an operation with a status, by code."""
    found = {
        code: example_refusal(code, operation).document(_REQUEST_ID)
        for code, problem in PROBLEMS.items()
        if problem.status == status and problem.concerns(operation)
    }
    return {code: {"summary": each["detail"], "value": each} for code, each in found.items()}
