"""Requests to plan, as they travel: JSON, and beside it what is better sent as a file."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
from paretour.values import CoverageRequest, FrontRequest

_USUAL_TIME_LIMIT = 1.0  # what the service takes where a request says nothing
_BOUND_SECONDS = 5.0  # what it takes at most to prove a bound


@dataclass(frozen=True)
class File:
    """The content of a part of a request, and the part's name."""

    part: str
    content: bytes


@dataclass(frozen=True)
class Plan:
    """Where a request is posted, and what it says."""

    path: str
    request: Mapping[str, Any]
    file: File | None = None

    @property
    def seconds(self) -> float:
        """How long the search for an answer may take, by what is asked, if that makes sense."""
        limit = self.request.get("time_limit", _USUAL_TIME_LIMIT)
        bound = _BOUND_SECONDS if self.request.get("bound") else 0.0
        return bound + (limit if isinstance(limit, int | float) else _USUAL_TIME_LIMIT)

    @property
    def json(self) -> bytes:
        """What is not in the file."""
        return json.dumps(self.request, default=_plain).encode()

    @property
    def body(self) -> dict[str, Any]:
        """What httpx is told of it."""
        if self.file is None:
            return {"content": self.json, "headers": {"Content-Type": "application/json"}}
        parts = {"request": self.json, self.file.part: self.file.content}
        return {"files": {name: (name, content) for name, content in parts.items()}}


def front_plan(request: FrontRequest) -> Plan:
    """A plan for cities. Matrices that are an array travel as it lies in memory."""
    given: dict[str, Any] = dict(request)
    if not isinstance(given.get("matrices"), np.ndarray):
        return Plan("/front", given)
    content = BytesIO()
    np.save(content, given.pop("matrices"), allow_pickle=False)
    return Plan("/front", given, File("matrices", content.getvalue()))


def coverage_plan(request: CoverageRequest, png: bytes | None) -> Plan:
    """A plan for a map, which is the request's grid or the content of a PNG file."""
    return Plan("/coverage", request, None if png is None else File("map", png))


def _plain(array: Any) -> Any:
    """What JSON has for an array, or for a number of one."""
    return array.tolist()
