"""Build the requests that have a front planned: JSON, and a file beside it where one is better."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
from paretour.values import CoverageRequest, FrontRequest

_DEFAULT_TIME_LIMIT = 1.0  # seconds, the service's own
_BOUND_SECONDS = 5.0  # that the service takes at most to prove a bound


@dataclass(frozen=True)
class File:
    """A file of a multipart request: the name of its part, and its content."""

    part: str
    content: bytes


@dataclass(frozen=True)
class Plan:
    """A request to plan: the path to post to, its JSON members, and maybe a file."""

    path: str
    request: Mapping[str, Any]
    file: File | None = None

    @property
    def seconds(self) -> float:
        """The most seconds that search and bound may take; the default for an invalid limit."""
        limit = self.request.get("time_limit", _DEFAULT_TIME_LIMIT)
        bound = _BOUND_SECONDS if self.request.get("bound") else 0.0
        return bound + (limit if isinstance(limit, int | float) else _DEFAULT_TIME_LIMIT)

    @property
    def json(self) -> bytes:
        """The members as JSON, without the file."""
        return json.dumps(self.request, default=_listed).encode()

    @property
    def body(self) -> dict[str, Any]:
        """The keyword arguments of httpx.Client.request for the body."""
        if self.file is None:
            return {"content": self.json, "headers": {"Content-Type": "application/json"}}
        parts = {"request": self.json, self.file.part: self.file.content}
        return {"files": {name: (name, content) for name, content in parts.items()}}


def front_plan(request: FrontRequest) -> Plan:
    """Return the request to POST /front, with matrices that are an array as a NumPy file."""
    members: dict[str, Any] = dict(request)
    if not isinstance(members.get("matrices"), np.ndarray):
        return Plan("/front", members)
    content = BytesIO()
    np.save(content, members.pop("matrices"), allow_pickle=False)
    return Plan("/front", members, File("matrices", content.getvalue()))


def coverage_plan(request: CoverageRequest, png: bytes | None) -> Plan:
    """Return the request to POST /coverage. The map is in it, or a PNG or PGM file."""
    return Plan("/coverage", request, None if png is None else File("map", png))


def _listed(array: Any) -> Any:
    """Return an array as nested lists, and a scalar of NumPy as a number."""
    return array.tolist()
