"""A front in the form in which it travels and is kept: JSON, written once, where it was found."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic_core import to_json

from service.instance import Instance
from service.planner import Front, Interim
from service.requests.task import Task


@dataclass(frozen=True, eq=False)
class FrontDocument:
    """A front of m tours as JSON.

    `members` are all the members of the answer but the tours. `tours` is the inside of the array
    of these. Where each tour ends in it, and its direction in degrees, are numbers of 8 bytes, in
    the form in which they travel and are kept. `gained` is for whoever watches the service.
    """

    members: dict[str, Any]
    tours: bytes
    ends: bytes
    angles: bytes
    gained: float | None = None

    def nearest(self, angle: float) -> bytes:
        """The tour whose direction is nearest to the angle in degrees, as a JSON object."""
        index = int(np.abs(np.frombuffer(self.angles) - angle).argmin())
        ends = np.frombuffer(self.ends, np.int64)
        begin = int(ends[index - 1]) + 1 if index else 0
        return self.tours[begin : int(ends[index])]

    def json(self, **more: Any) -> bytes:
        """The answer, which begins with these other members."""
        members = to_json({**more, **self.members})
        return b"".join((members[:-1], b',"front":[', self.tours, b"]}"))


def rendered(
    front: Front, each: Iterable[Mapping[str, Any]] | None = None, **more: Any
) -> FrontDocument:
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
    angles = front.angles.tobytes()
    return FrontDocument(members, b",".join(tours), ends.tobytes(), angles, front.gained)


def empty(**more: Any) -> FrontDocument:
    """A front of which nothing has been found, with other members."""
    members = {
        "points": 0,
        "hypervolume": 0.0,
        "hypervolume_bound": None,
        "timings_ms": {},
        "terminated": None,
        **more,
    }
    return FrontDocument(members, b"", b"", b"")


@dataclass(frozen=True, eq=False)
class Sketch:
    """How far a search has come. `front` writes the best so many tours found so far."""

    seconds: float
    hypervolume: float
    points: int
    front: Callable[[int], FrontDocument]


def sketched(interim: Interim, **more: Any) -> Sketch:
    """What a search reports, of which the front is written, with other members, if it is asked."""
    return Sketch(
        interim.seconds,
        interim.hypervolume,
        interim.points,
        lambda size: rendered(interim.front(size), **more),
    )


def nothing_yet(task: Task, actor: Mapping[str, str]) -> FrontDocument:
    """The front before anything is found."""
    subject, reference_point = task.subject, task.demand.reference_point
    if isinstance(subject, Instance):
        if reference_point is None:
            reference_point = subject.n * subject.scale
        known = {"cities": subject.n, "scale": subject.scale.tolist()}
    else:
        # What the places cost, and with a spacing which they are, is for a worker to find.
        places = [] if subject.places is None else subject.places.tolist()
        known = {"cities": len(places), "scale": None, "places": places}
    return empty(
        **known,
        reference_point=None if reference_point is None else reference_point.tolist(),
        actor=actor,
    )
