"""A front as JSON: the one form in which it travels between processes, is stored and answered.

To add a member to the answer, add a field to `FrontDocument` and fill it in `encode_front` and
`empty_front`. Stores, engines and routes pass all members on by themselves. A field that is not in
the documents stored by earlier releases needs a default.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from service.coverage.survey import CoveragePath
from service.instance import Instance
from service.planner import Front
from service.requests.stops import Labels, UnmeasuredStops
from service.requests.task import Task
from service.search.improve import Termination

PATH_PART = 2**14  # cells of a path that are written at once


@dataclass(frozen=True)
class Timings:
    """Milliseconds of each phase of planning, and from the request to its end, once it has ended.

    Their JSON form is one object: the time in the queue, the phases, the total.
    """

    phases: Mapping[str, float]
    total: float | None = None

    @classmethod
    def from_json(cls, members: Mapping[str, float]) -> Self:
        """Return the timings of a parsed JSON object."""
        phases = {name: ms for name, ms in members.items() if name not in ("queue", "total")}
        return cls(phases, members.get("total"))

    def as_json(self) -> dict[str, float]:
        """Return the members of the JSON object."""
        if self.total is None:
            return dict(self.phases)
        queue = self.total - sum(self.phases.values())
        return {"queue": queue, **self.phases, "total": self.total}


@dataclass(frozen=True, eq=False, kw_only=True)
class FrontDocument:
    """A front of m tours as JSON.

    All fields but the last four are members of the answer, in this order. A member whose default
    is None is left out while it is None.

    Attributes:
        reference_point: One number for each objective; None while the places are not known.
        scale: The same.
        actor: Name and digest of the network; None where it built no tours.
        places: Row and column of each place of a coverage task.
        objectives: Name and unit of each objective, where the caller named them.
        stops: Id and location of each stop, where the caller named them.
        tours: The JSON of all tours, with commas between, without brackets.
        ends: Where each tour ends in `tours`, as m native integers of 8 bytes.
        angles: The direction of each tour in degrees, as m native floats of 8 bytes.
        gained: The hypervolume that the search added, for the metrics.
    """

    cities: int
    points: int
    hypervolume: float
    hypervolume_bound: float | None
    reference_point: list[float] | None
    scale: list[float] | None
    timings_ms: Timings
    terminated: Termination | None
    actor: Mapping[str, str] | None
    places: list[list[int]] | None = None
    objectives: list[dict[str, Any]] | None = None
    stops: list[dict[str, Any]] | None = None
    tours: bytes = b""
    ends: bytes = b""
    angles: bytes = b""
    gained: float | None = None

    @classmethod
    def from_members(cls, members: Mapping[str, Any], **encoded: Any) -> Self:
        """Return the document of parsed members, with the other fields as given.

        Members that this release does not know are dropped.
        """
        known = {name: members[name] for name in _MEMBERS if name in members}
        timings = Timings.from_json(known.pop("timings_ms"))
        return cls(**known, timings_ms=timings, **encoded)

    def members(self) -> dict[str, Any]:
        """Return the members of the answer but the tours, ready for JSON."""
        values = {name: getattr(self, name) for name in _MEMBERS}
        given = {k: v for k, v in values.items() if v is not None or k not in _OPTIONAL}
        return {**given, "timings_ms": self.timings_ms.as_json()}

    def json(self, **more: Any) -> bytes:
        """Return the answer as JSON, beginning with these other members."""
        members = to_json({**more, **self.members()})
        return b"".join((members[:-1], b',"front":[', self.tours, b"]}"))

    def nearest(self, angle: float) -> bytes:
        """Return the tour whose direction is nearest to the angle in degrees, as JSON."""
        index = int(np.abs(np.frombuffer(self.angles) - angle).argmin())
        ends = np.frombuffer(self.ends, np.int64)
        begin = int(ends[index - 1]) + 1 if index else 0
        return self.tours[begin : int(ends[index])]

    def without_tours(self) -> Self:
        """Return the front with none of its tours."""
        return replace(self, tours=b"", ends=b"", angles=b"")

    def ended(self, seconds: float, *, late: bool) -> Self:
        """Return the front as it ended, so many seconds after the request.

        Args:
            seconds: From the request to the end.
            late: Whether planning was ended because it took too long.
        """
        terminated = self.terminated
        if terminated in (None, "cancelled"):
            terminated = "time_limit" if late else "cancelled"
        timings = replace(self.timings_ms, total=1000 * seconds)
        return replace(self, timings_ms=timings, terminated=terminated)


_ENCODED = ("tours", "ends", "angles", "gained")
_MEMBER_FIELDS = [field for field in fields(FrontDocument) if field.name not in _ENCODED]
_MEMBERS = tuple(field.name for field in _MEMBER_FIELDS)
_OPTIONAL = {field.name for field in _MEMBER_FIELDS if field.default is None}


def encode_front(
    front: Front,
    actor: Mapping[str, str],
    places: list[list[int]] | None = None,
    paths: Iterable[CoveragePath] | None = None,
    labels: Labels | None = None,
) -> FrontDocument:
    """Write a front as JSON: with paths the path of each tour, with labels the ids of its stops.

    The actor is left out where it built no tours.
    """
    rows = zip(front.angles.tolist(), front.points.tolist(), front.tours.tolist(), strict=True)
    ids = None if labels is None else [stop.id for stop in labels.stops]
    encoded = [_encode_tour(angle, lengths, tour, ids) for angle, lengths, tour in rows]
    if paths is not None:
        encoded = [
            b"".join((tour[:-1], b',"path":', _encode_path(path), b"}"))
            for tour, path in zip(encoded, paths, strict=True)
        ]
    ends = np.cumsum([len(tour) + 1 for tour in encoded], dtype=np.int64) - 1
    return FrontDocument(
        cities=front.n,
        points=front.found,
        hypervolume=front.hypervolume,
        hypervolume_bound=front.bound,
        reference_point=front.reference_point.tolist(),
        scale=front.scale.tolist(),
        timings_ms=Timings(front.timings),
        terminated=front.terminated,
        actor=actor if front.constructed else None,
        places=places,
        **_named(labels),
        tours=b",".join(encoded),
        ends=ends.tobytes(),
        angles=front.angles.tobytes(),
        gained=front.gained,
    )


def _encode_tour(
    angle: float, lengths: list[float], tour: list[int], ids: Sequence[str] | None
) -> bytes:
    members: dict[str, object] = {"angle": angle, "lengths": lengths, "tour": tour}
    if ids is not None:
        members["stops"] = [ids[city] for city in tour]
    return to_json(members)


def _named(labels: Labels | None) -> dict[str, Any]:
    """Return the members of a document that hold the caller's names."""
    return {} if labels is None else asdict(labels)


def _encode_path(path: CoveragePath) -> bytes:
    """Return a path as JSON, written in parts: a list takes ten times the memory of its text."""
    parts = [path.cells[i : i + PATH_PART] for i in range(0, len(path.cells), PATH_PART)]
    members = [b'"cells":', *_encode_rows(parts), b',"metres":', to_json(path.metres)]
    if path.frame is not None:
        members += [b',"points":', *_encode_rows(map(path.frame.points, parts))]
    return b"".join((b"{", *members, b"}"))


def _encode_rows(parts: Iterable[NDArray[Any]]) -> tuple[bytes, bytes, bytes]:
    """Return a list of rows of numbers as JSON, from parts of them."""
    return b"[", b",".join(to_json(part.tolist())[1:-1] for part in parts), b"]"


def empty_front(task: Task) -> FrontDocument:
    """Return the document of a task of which nothing has been found yet."""
    subject, reference_point = task.subject, task.options.reference_point
    if isinstance(subject, Instance):
        cities, scale, places = subject.n, subject.scale.tolist(), None
        if reference_point is None:
            reference_point = subject.n * subject.scale
    elif isinstance(subject, UnmeasuredStops):
        cities, scale, places = subject.n, None, None
    else:
        # A worker finds out what the places cost, and with a spacing where they are.
        places = [] if subject.places is None else subject.places.tolist()
        cities, scale = len(places), None
    return FrontDocument(
        cities=cities,
        points=0,
        hypervolume=0.0,
        hypervolume_bound=None,
        reference_point=None if reference_point is None else reference_point.tolist(),
        scale=scale,
        timings_ms=Timings({}),
        terminated=None,
        actor=None,
        places=places,
        **_named(task.labels),
    )
