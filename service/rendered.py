"""A front in the form in which it travels and is kept: JSON, written once, where it was found."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from service.planner import Front, Interim


@dataclass(frozen=True, eq=False)
class Rendered:
    """A front of m tours as JSON.

    `members` are all the members of the answer but the tours. `tours` is the inside of the array
    of these: tour i, whose direction is angles[i] degrees, ends before byte ends[i]. `gained` is
    for whoever watches the service.
    """

    members: dict[str, Any]
    tours: bytes
    ends: NDArray[np.int64]
    angles: NDArray[np.float64]
    gained: float | None = None

    def nearest(self, angle: float) -> bytes:
        """The tour whose direction is nearest to the angle in degrees, as a JSON object."""
        index = int(np.abs(self.angles - angle).argmin())
        begin = int(self.ends[index - 1]) + 1 if index else 0
        return self.tours[begin : int(self.ends[index])]

    def json(self, **more: Any) -> bytes:
        """The answer, which begins with these other members."""
        members = to_json({**more, **self.members})
        return b"".join((members[:-1], b',"front":[', self.tours, b"]}"))


def rendered(
    front: Front, each: Iterable[Mapping[str, Any]] | None = None, **more: Any
) -> Rendered:
    """A front as JSON, with other members, of each tour and of the whole."""
    members = {
        "cities": front.n,
        "points": front.found,
        "hypervolume": front.hypervolume,
        "hypervolume_bound": front.bound,
        "reference_point": front.reference_point.tolist(),
        "scale": front.scale.tolist(),
        "timings_ms": front.timings,
        "terminated": front.terminated,
        **more,
    }
    rows = zip(front.angles.tolist(), front.points.tolist(), front.tours.tolist(), strict=True)
    each = each or ({} for _ in front.points)
    tours = [
        to_json({"angle": a, "lengths": f, "tour": tour, **others})
        for (a, f, tour), others in zip(rows, each, strict=True)
    ]
    ends = np.cumsum([len(tour) + 1 for tour in tours], dtype=np.int64) - 1
    return Rendered(members, b",".join(tours), ends, front.angles, front.gained)


def empty(**more: Any) -> Rendered:
    """A front of which nothing has been found, with other members."""
    members = {
        "points": 0,
        "hypervolume": 0.0,
        "hypervolume_bound": None,
        "timings_ms": {},
        "terminated": None,
        **more,
    }
    return Rendered(members, b"", np.empty(0, np.int64), np.empty(0))


@dataclass(frozen=True, eq=False)
class Sketch:
    """How far a search has come. `front` writes the best so many tours found so far."""

    seconds: float
    hypervolume: float
    points: int
    front: Callable[[int], Rendered]


def sketched(interim: Interim, **more: Any) -> Sketch:
    """What a search reports, of which the front is written, with other members, if it is asked."""
    return Sketch(
        interim.seconds,
        interim.hypervolume,
        interim.points,
        lambda size: rendered(interim.front(size), **more),
    )
