"""A front as JSON: the one form in which it is sent between processes, stored and answered.

To add a member to the answer, add a field to `FrontDocument` and fill it in `encode_front` and
`empty_front`. Stores, engines and routes pass all members on by themselves. A field that is not in
the documents stored by earlier releases needs a default.
"""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic_core import from_json, to_json

from service.coverage.survey import CoveragePath, Survey
from service.instance import OBJECTIVES, Instance
from service.jobs.json_parts import encode_path, encode_tours, joined, split, with_member
from service.pareto import balances
from service.planner import Front
from service.requests.stops import Labels, UnmeasuredStops
from service.requests.task import Task
from service.search.improve import Termination

_HEAD = 100  # the first bytes of a tour, which contain its first members


@dataclass(frozen=True)
class Timings:
    """Milliseconds of each phase of planning; once it has ended, also those since the request.

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
        closed: False where tours are open routes; None where they are closed.
        objectives: Name and unit of each objective, where the caller named them.
        stops: Id and location of each stop, where the caller named them.
        uncovered: The free cells of a map that are out of reach.
        tours: The JSON of all tours, separated by commas, without brackets.
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
    closed: bool | None = None
    objectives: list[dict[str, Any]] | None = None
    stops: list[dict[str, Any]] | None = None
    uncovered: dict[str, Any] | None = None
    tours: bytes = b""
    ends: bytes = b""
    angles: bytes = b""
    gained: float | None = None

    @classmethod
    def from_members(cls, members: Mapping[str, Any], **encoded: Any) -> Self:
        """Return the document of parsed members, with the other fields as given.

        Members that this release does not know are dropped. Tours of releases without balances get
        theirs.
        """
        known = {name: members[name] for name in _MEMBERS if name in members}
        timings = Timings.from_json(known.pop("timings_ms"))
        return cls(**known, timings_ms=timings, **encoded).with_balances()

    def with_balances(self) -> Self:
        """Return the front with the balance of each tour, computed where it is missing."""
        if b'"balance":' in self.tours[:_HEAD]:
            return self
        tours, ends = joined(
            tour.replace(b',"lengths":', b',"balance":' + to_json(balance) + b',"lengths":', 1)
            for tour, balance in zip(self.split(), balances(self.lengths).tolist(), strict=True)
        )
        return replace(self, tours=tours, ends=ends)

    def members(self) -> dict[str, Any]:
        """Return the members of the answer but the tours, ready for JSON."""
        values = {name: getattr(self, name) for name in _MEMBERS}
        given = {k: v for k, v in values.items() if v is not None or k not in _OPTIONAL}
        return {**given, "timings_ms": self.timings_ms.as_json()}

    def json(self, **more: Any) -> bytes:
        """Return the answer as JSON, beginning with these other members."""
        members = to_json({**more, **self.members()})
        return b"".join((members[:-1], b',"front":[', self.tours, b"]}"))

    @property
    def directions(self) -> NDArray[np.float64]:
        """The direction of each tour in degrees, shape (m,)."""
        return np.frombuffer(self.angles)

    @property
    def lengths(self) -> NDArray[np.float64]:
        """The lengths of each tour, shape (m, 2)."""
        return np.array([_lengths(tour) for tour in self.split()]).reshape(-1, OBJECTIVES)

    def split(self) -> list[bytes]:
        """Return the JSON of each tour."""
        return split(self.tours, self.ends)

    def tour(self, index: int) -> bytes:
        """Return the JSON of one tour."""
        return self.split()[index]

    def without_tours(self) -> Self:
        """Return the front without its tours."""
        return replace(self, tours=b"", ends=b"", angles=b"")

    def ended(self, seconds: float, *, late: bool) -> Self:
        """Return the front with its timings at the end.

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


def _lengths(tour: bytes) -> list[float]:
    """Return the lengths in the JSON of a tour; only members that are numbers come before them."""
    lengths: list[float] = from_json(tour[: tour.index(b"]") + 1] + b"}")["lengths"]
    return lengths


def encode_front(
    front: Front,
    actor: Mapping[str, str],
    surveyed: Survey | None = None,
    paths: Iterable[CoveragePath] | None = None,
    labels: Labels | None = None,
    arrivals: NDArray[np.float64] | None = None,
) -> FrontDocument:
    """Write a front as JSON: its tours with the ids of labels, and with arrivals and paths if any.

    The front of a map has the places and the uncovered cells of the survey.

    The actor is left out where it built no tours. Arrivals have shape (m, stops, 2).
    """
    tours, ends = encode_tours(_rows(front, arrivals))
    if labels is not None:
        tours, ends = joined(_with_stops(split(tours, ends), front.tours, labels))
    if paths is not None:
        tours, ends = joined(
            with_member(tour, b"path", encode_path(path))
            for tour, path in zip(split(tours, ends), paths, strict=True)
        )
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
        **on_map(surveyed),
        closed=None if front.closed else False,
        **_named(labels),
        tours=tours,
        ends=ends,
        angles=front.angles.tobytes(),
        gained=front.gained,
    )


def on_map(surveyed: Survey | None) -> dict[str, Any]:
    """Return the members of a document about a map: its places and its uncovered cells."""
    if surveyed is None:
        return {}
    return {"places": surveyed.places.tolist(), "uncovered": asdict(surveyed.uncovered)}


def _rows(front: Front, arrivals: NDArray[np.float64] | None) -> list[dict[str, Any]]:
    """Return the members of each tour, all of them numbers, ready for JSON."""
    columns = zip(
        front.angles.tolist(),
        balances(front.points).tolist(),
        _optional("kept", front.kept, front),
        front.points.tolist(),
        front.tours.tolist(),
        _optional("arrivals", arrivals, front),
        strict=True,
    )
    return [
        {"angle": angle, "balance": balance, **kept, "lengths": lengths, "tour": tour, **arrived}
        for angle, balance, kept, lengths, tour, arrived in columns
    ]


def _optional(name: str, values: NDArray[np.float64] | None, front: Front) -> list[dict[str, Any]]:
    """Return a member for each tour of a front; without values, no members."""
    if values is None:
        return [{}] * len(front.tours)
    return [{name: value} for value in values.tolist()]


def _with_stops(encoded: list[bytes], tours: NDArray[np.integer], labels: Labels) -> list[bytes]:
    """Return the JSON of each tour with the ids of its stops. Each id is encoded once."""
    ids = np.array([to_json(stop.id) for stop in labels.stops], object)
    return [
        with_member(tour, b"stops", b"[%b]" % b",".join(stops))
        for tour, stops in zip(encoded, ids[tours].tolist(), strict=True)
    ]


def _named(labels: Labels | None) -> dict[str, Any]:
    """Return the members of a document that hold the caller's names."""
    return {} if labels is None else labels.members


def empty_front(task: Task) -> FrontDocument:
    """Return the document of a task of tours before anything is found."""
    subject: Any = task.subject
    reference_point = task.options.reference_point
    if isinstance(subject, Instance):
        cities, scale, places = subject.n, subject.scale.tolist(), None
        if reference_point is None:
            reference_point = subject.reference_point
    elif isinstance(subject, UnmeasuredStops):
        cities, scale, places = subject.n, None, None
    else:
        places = [] if subject.places is None else subject.places.tolist()
        cities, scale = len(places), None  # a worker finds out their costs
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
        closed=None if subject.ends.closed else False,
        **_named(task.labels),
    )
