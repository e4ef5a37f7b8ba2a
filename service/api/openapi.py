"""Summaries and examples in the OpenAPI document: of each path a request, its answer, all refusals.

A path's summary is the first line of its docstring. Examples are kept in `reference/examples.json`:
requests and answers by operation, as "POST /front"; of each refusal what fills in its sentence, and
where one operation needs another example than the rest, by "code of POST /front".
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from service.api.responses import PROBLEM_JSON
from service.errors import PROBLEMS, Refusal

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
            if PROBLEM_JSON in content:
                content[PROBLEM_JSON]["examples"] = _refusals(kept["refusals"], name, int(status))


def _operations(document: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            yield f"{method.upper()} {path}", operation


def _refusals(examples: dict[str, Any], name: str, status: int) -> dict[str, Any]:
    found = {
        code: Refusal(code, **_filled(examples, code, name)).document(_REQUEST_ID)
        for code, problem in PROBLEMS.items()
        if problem.status == status and problem.concerns(name)
    }
    return {code: {"summary": each["detail"], "value": each} for code, each in found.items()}


def _filled(examples: dict[str, Any], code: str, name: str) -> dict[str, Any]:
    filled: dict[str, Any] = examples.get(f"{code} of {name}", examples.get(code, {}))
    return filled
