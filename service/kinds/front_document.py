"""A front as JSON: the one form in which it is sent between processes, stored and answered.

To add a member to the answer, declare it in the client, on `StoredFront` or on a front of one kind,
add a field to `FrontDocument`, and fill it in where documents are written: `empty_document` in
`table`, `tour_document`, `fleet` and `robots`. Stores, engines and routes pass on all members
without knowing them. A field that earlier releases did not store needs a default.
"""

from array import array
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from itertools import accumulate, islice
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic_core import from_json, to_json

from service.coverage.frame import CoveragePath
from service.fleet.plans import FleetFront
from service.front import Front, Termination
from service.objectives import OBJECTIVES
from service.preferences import angles
from service.requests.notes.note import Note
from service.requests.task import KindName

PATH_PART = 2**14  # cells of a path that are written at once


@dataclass(frozen=True, eq=False, kw_only=True)
class FrontDocument:
    """A front of m tours as JSON.

    All fields but the last four are members of the answer, in this order; the client's fronts say
    what each is. A member whose default is None is left out while it is None.

    Attributes:
        tours: The JSON of all tours, separated by commas, without brackets.
        ends: Where each tour ends in `tours`, as m native integers of 8 bytes.
        lengths: The lengths of each of m tours, shape (m, k).
        gained: The hypervolume that the search added, for the metrics.
    """

    kind: KindName
    cities: int
    points: int
    hypervolume: float
    hypervolume_bound: float | None
    reference_point: list[float] | None
    scale: list[float] | None
    timings_ms: Mapping[str, float]
    terminated: Termination | None
    actor: Mapping[str, str] | None
    places: list[list[int]] | None = None
    closed: bool | None = None
    objectives: list[dict[str, Any]] | None = None
    stops: list[dict[str, Any]] | None = None
    clock: dict[str, Any] | None = None
    driven: list[float] | None = None
    uncovered: dict[str, Any] | None = None
    notes: list[dict[str, str]] | None = None
    tours: bytes = b""
    ends: bytes = b""
    lengths: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, OBJECTIVES)))
    gained: float | None = None

    @classmethod
    def of(cls, front: Front | FleetFront, **members: Any) -> Self:
        """Return the document of a front that was found, with these other members."""
        return cls(
            points=front.found,
            hypervolume=front.hypervolume,
            reference_point=front.reference_point.tolist(),
            scale=front.scale.tolist(),
            timings_ms=front.timings,
            terminated=front.terminated,
            lengths=front.points,
            **members,
        )

    @classmethod
    def from_members(cls, members: Mapping[str, Any], **encoded: Any) -> Self:
        """Return the document of the members that a store has, with the other fields as given.

        Members that this release does not know are dropped.
        """
        known = {name: members[name] for name in _MEMBERS if name in members}
        document = cls(**known, **encoded)
        if "lengths" not in members:
            return document._of_version_before()
        return replace(document, lengths=_as_array(members["lengths"]))

    def with_notes(self, notes: Iterable[Note]) -> Self:
        """Return the front with notes on its request, if there are any."""
        members = [
            {name: value for name, value in vars(note).items() if value is not None}
            for note in notes
        ]
        return replace(self, notes=members) if members else self

    def _of_version_before(self) -> Self:
        """Return a front that was stored without its lengths, with them."""
        lengths = [from_json(tour)["lengths"] for tour in self.split()]
        return replace(self, lengths=_as_array(lengths))

    def stored(self) -> bytes:
        """Return the members of the answer but the tours, and the lengths of these, as JSON."""
        return to_json({**self.members(), "lengths": self.lengths.tolist()})

    def members(self) -> dict[str, Any]:
        """Return the members of the answer but the tours, ready for JSON."""
        values = {name: getattr(self, name) for name in _MEMBERS}
        return {k: v for k, v in values.items() if v is not None or k not in _OPTIONAL}

    def json(self, **more: Any) -> bytes:
        """Return the answer as JSON, beginning with these other members."""
        members = to_json({**more, **self.members()})
        return b"".join((members[:-1], b',"front":[', self.tours, b"]}"))

    @property
    def phases(self) -> dict[str, float]:
        """The milliseconds of each phase of planning."""
        timings = self.timings_ms.items()
        return {name: ms for name, ms in timings if name not in ("queue", "total")}

    @property
    def directions(self) -> NDArray[np.float64]:
        """The direction of each tour in degrees, shape (m,); of more than two objectives NaN."""
        if not len(self.lengths) or self.lengths.shape[1] > OBJECTIVES:
            return np.full(len(self.lengths), np.nan)
        return angles(self.lengths, np.array(self.scale))

    @property
    def orders(self) -> NDArray[np.int64]:
        """The stops of each tour in order, shape (m, n); not for plans, which have routes."""
        texts = [_between(tour, b'"tour":[', b"]") for tour in self.split()]
        # This takes a fifth of the time of parsing JSON, and paths over a map are not parsed.
        stops = np.fromstring(b",".join(texts), np.int64, sep=",")
        return stops.reshape(len(texts), -1) if texts else np.empty((0, 0), np.int64)

    def split(self) -> list[bytes]:
        """Return the JSON of each tour."""
        return [self.tour(index) for index in range(len(np.frombuffer(self.ends, np.int64)))]

    def tour(self, index: int) -> bytes:
        """Return the JSON of one tour."""
        ends = np.frombuffer(self.ends, np.int64)
        return self.tours[ends[index - 1] + 1 if index else 0 : ends[index]]

    def without_tours(self) -> Self:
        """Return the front without its tours."""
        return replace(self, tours=b"", ends=b"", lengths=self.lengths[:0])

    def ended(self, seconds: float, *, late: bool) -> Self:
        """Return the front with its timings at the end.

        Args:
            seconds: The seconds from the request to the end.
            late: Whether planning was ended because it took too long.
        """
        terminated = self.terminated
        if terminated in (None, "cancelled"):
            terminated = "time_limit" if late else "cancelled"
        phases, total = self.phases, 1000 * seconds
        timings = {"queue": total - sum(phases.values()), **phases, "total": total}
        return replace(self, timings_ms=timings, terminated=terminated)


_ENCODED = ("tours", "ends", "lengths", "gained")
_MEMBER_FIELDS = [field for field in fields(FrontDocument) if field.name not in _ENCODED]
_MEMBERS = tuple(field.name for field in _MEMBER_FIELDS)
_OPTIONAL = {field.name for field in _MEMBER_FIELDS if field.default is None}


def _as_array(lengths: list[list[float]]) -> NDArray[np.float64]:
    return np.array(lengths or np.empty((0, OBJECTIVES)), np.float64)


def _between(text: bytes, before: bytes, after: bytes) -> bytes:
    """Return the text between the first of two parts, and the next of the other."""
    at = text.index(before) + len(before)
    return text[at : text.index(after, at)]


def joined(tours: Iterable[bytes]) -> tuple[bytes, bytes]:
    """Join the JSON of tours; return it and where each tour ends in it."""
    each = list(tours)
    ends = accumulate(each, lambda end, tour: end + 1 + len(tour), initial=-1)
    return b",".join(each), array("q", islice(ends, 1, None)).tobytes()


def with_member(encoded: bytes, name: bytes, value: bytes) -> bytes:
    """Return the JSON of an object that is not empty, with one more member at its end."""
    return b"".join((encoded[:-1], b',"', name, b'":', value, b"}"))


def encode_path(path: CoveragePath) -> bytes:
    """Return a path as JSON, written in parts: a list takes ten times the memory of its text."""
    parts = [path.cells[i : i + PATH_PART] for i in range(0, len(path.cells), PATH_PART)]
    members = [b'"cells":', *_encode_rows(parts), b',"metres":', to_json(path.metres)]
    members += [b',"visits":', to_json(path.visits.tolist())]
    if path.frame is not None:
        members += [b',"points":', *_encode_rows(map(path.frame.points, parts))]
        yaws = path.frame.yaws(path.cells)
        yaw_parts = (yaws[i : i + PATH_PART] for i in range(0, len(yaws), PATH_PART))
        members += [b',"yaws":', *_encode_rows(yaw_parts)]
    return b"".join((b"{", *members, b"}"))


def _encode_rows(parts: Iterable[NDArray[Any]]) -> tuple[bytes, bytes, bytes]:
    """Return a list of rows of numbers as JSON, from parts of them."""
    return b"[", b",".join(to_json(part.tolist())[1:-1] for part in parts), b"]"
