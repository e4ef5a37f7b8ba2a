"""Build the requests that plan a front: JSON, and a file beside it for large arrays."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from io import BytesIO
from typing import Any
from urllib.parse import quote

import numpy as np
from numpy.typing import ArrayLike, NDArray
from paretour.arrays import plain_object
from paretour.frames import COSTS, Costs, Frame, has_ids, without_frames
from paretour.members import (
    BOUND_SECONDS,
    DEFAULT_TIME_LIMIT,
    CoverageRequest,
    FleetRequest,
    FrontRequest,
    OffersRequest,
    ReplanFleetRequest,
    ReplanRequest,
    RobotsRequest,
    StopRequest,
)
from paretour.plans import FleetFront
from paretour.values import Front

# Coordinates, matrices or stops.
Instance = ArrayLike | Sequence[Costs] | Sequence[StopRequest] | Frame

_OBJECTIVES = (2, 3, 4)
_MEMBERS = {2: "coordinates", 3: "matrices"}  # by the dimensions of an array


@dataclass(frozen=True)
class File:
    """A file of a multipart request: the name of its part, and its content."""

    part: str
    content: bytes


def parts_of(
    files: Mapping[str, bytes], columns: Sequence[Mapping[str, str]]
) -> list[tuple[str, tuple[str | None, str | bytes]]]:
    """Return the parts of a form: files, and what their columns are taken for, if that is given."""
    chosen = [("columns", (None, json.dumps([*map(dict, columns)])))] if columns else []
    # The name of a file on a disk may be no text.
    named = [(name.encode(errors="replace").decode(), data) for name, data in files.items()]
    return [*(("file", each) for each in named), *chosen]


@dataclass(frozen=True)
class Plan:
    """A request to plan: the path to post to, its JSON members, and maybe a file."""

    path: str
    request: Mapping[str, Any]
    file: File | None = None

    @property
    def seconds(self) -> float:
        """The most seconds that search and bound may take; the default for an invalid limit."""
        limit = self.request.get("time_limit", DEFAULT_TIME_LIMIT)
        bound = BOUND_SECONDS if self.request.get("bound") else 0.0
        return bound + (limit if isinstance(limit, int | float) else DEFAULT_TIME_LIMIT)

    @property
    def json(self) -> bytes:
        """The members as JSON, without the file. Infinite costs become null."""
        try:
            return json.dumps(self.request, default=plain_object, allow_nan=False).encode()
        except ValueError:
            return json.dumps(_with_null(self.request), default=plain_object).encode()

    @property
    def body(self) -> dict[str, Any]:
        """The keyword arguments of httpx.Client.request for the body."""
        if self.file is None:
            return {"content": self.json, "headers": {"Content-Type": "application/json"}}
        parts = {"request": self.json, self.file.part: self.file.content}
        return {"files": {name: (name, content) for name, content in parts.items()}}


@dataclass(frozen=True, eq=False)
class PlanOfFiles(Plan, Mapping[str, Any]):
    """The request in files, ready to be planned, and a mapping of the answer that told it.

    The mapping has `kind`, `request`, `notes` and, of tables, what `columns` are taken for.
    """

    answer: Mapping[str, Any] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Any:
        return self.answer[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.answer)

    def __len__(self) -> int:
        return len(self.answer)


def front_plan(request: FrontRequest, instance: Instance | None = None) -> Plan:
    """Return the request to POST /front, with matrices that are arrays as a NumPy file.

    The file holds `matrices`, which may be DataFrames, or the matrices of all objectives, if these
    are arrays of numbers. Arrays of objects are sent as JSON, with null for None.

    Args:
        request: The members of the request.
        instance: Its coordinates, its matrices or its stops, unless they are among the members.

    Raises:
        TypeError: They are among the members as well.
        ValueError: The instance is none of these. Or as of without_frames.
    """
    members: dict[str, Any] = without_frames({**request, **_named(instance, request)})
    objectives: Sequence[Mapping[str, Any]] = members.get("objectives", ())
    if _fit_a_file(members.get("matrices")):
        members["matrices"] = np.stack(members["matrices"])
    if _is_array(members.get("matrices")):
        return Plan("/front", members, _matrices_file(members.pop("matrices")))
    matrices: list[Any] = [objective.get("matrix") for objective in objectives]
    if not _fit_a_file(matrices):
        return Plan("/front", members)
    named = [{k: v for k, v in each.items() if k != "matrix"} for each in objectives]
    return Plan("/front", {**members, "objectives": named}, _matrices_file(np.stack(matrices)))


def _named(instance: Instance | None, request: FrontRequest) -> dict[str, Any]:
    """Return an instance as the member of a request that it is."""
    if instance is None:
        return {}
    known = [name for name in ("coordinates", "matrices", "stops") if name in request]
    if known:
        raise TypeError(f"there is an instance before the members of the request, and {known[0]}")
    return {_kind_of(instance): instance}


def _kind_of(instance: Instance) -> str:
    """Return the name of the member of a request that an instance is."""
    if hasattr(instance, "to_numpy"):
        return "stops" if has_ids(instance) else "coordinates"
    rows: Any = instance
    first: Any = rows[0] if len(rows) else ()
    if isinstance(first, Mapping):
        return "stops"
    dimensions = 1 + np.ndim(first)
    if dimensions not in _MEMBERS:
        raise ValueError(
            "instance must be coordinates (a row for each city), matrices (a square for each "
            f"objective) or stops (each with an id), got {dimensions} dimensions"
        )
    return _MEMBERS[dimensions]


def _fit_a_file(matrices: Any) -> bool:
    """Return whether matrices are arrays of the same shape, which a file needs."""
    if not isinstance(matrices, list) or len(matrices) not in _OBJECTIVES:
        return False
    if not all(map(_is_array, matrices)):
        return False
    return matrices[0].ndim == 2 and len({each.shape for each in matrices}) == 1


def _is_array(matrices: Any) -> bool:
    """Return whether matrices are an array that a file can hold: not an array of objects."""
    return isinstance(matrices, np.ndarray) and not matrices.dtype.hasobject


def _matrices_file(matrices: NDArray[Any]) -> File:
    content = BytesIO()
    np.save(content, matrices, allow_pickle=False)
    return File("matrices", content.getvalue())


def coverage_plan(request: CoverageRequest | RobotsRequest, png: bytes | None) -> Plan:
    """Return the request to POST /coverage. The map is a member, or a PNG or PGM file."""
    return Plan("/coverage", without_frames(request), None if png is None else File("map", png))


def replan_plan(
    front: Front | FleetFront | str, request: ReplanRequest | ReplanFleetRequest
) -> Plan:
    """Return the request to replan a front, given as such or by its id."""
    path = front_path(front if isinstance(front, str) else front.id)
    return Plan(f"{path}/replan", without_frames(request))


def offers_plan(front: FleetFront | str, request: OffersRequest) -> Plan:
    """Return the request for offers about a front, given as such or by its id."""
    path = front_path(front if isinstance(front, str) else front.id)
    return Plan(f"{path}/offers", without_frames(request))


def front_path(front_id: str) -> str:
    """Return the path of a front; any characters in its id are escaped."""
    return f"/front/{quote(front_id, safe='')}"


def fleet_plan(request: FleetRequest) -> Plan:
    """Return the request to POST /fleet."""
    return Plan("/fleet", without_frames(request))


def _with_null(value: Any, is_cost: bool = False) -> Any:
    """Return members of a request with None in place of infinite costs."""
    if is_cost and isinstance(value, float):
        return None if value == np.inf else value
    if isinstance(value, Mapping):
        return {name: _with_null(each, is_cost or name in COSTS) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_with_null(each, is_cost) for each in value]
    if isinstance(value, Decimal) or hasattr(value, "tolist"):
        plain = plain_object(value)
        return _with_null(plain, is_cost) if plain is not value else value
    return value
