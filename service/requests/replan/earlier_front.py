"""The front that is replanned: its stops, costs, ends and tours, read from the store."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from service.errors import Refusal
from service.instance import OBJECTIVES, PLANE, RouteEnds
from service.pareto import balances, knee
from service.requests.front import FrontRequest
from service.requests.front_parser import parse_front_request
from service.requests.limits import Limits
from service.requests.replan.rest_request import RestRequest
from service.requests.stops import Labels, Matrix, Objective, Plane, Source, Stop
from service.requests.task import TaskSource
from service.search.open_routes import rotated

Array = NDArray[np.float64]
MOST_TOURS = 50  # of an earlier front to start the search from: the search has as many weights
_NAMES = ("first", "second")  # of objectives that the front's request did not name
# The members read of a tour. Its path has up to millions of cells, which take seconds to read.
_READ = re.compile(rb'"lengths":\s*\[([^]]*)],\s*"tour":\s*\[([^]]*)]')
_MODELS: Mapping[str, type[FrontRequest]] = {"front": FrontRequest, "replan": RestRequest}


@dataclass(frozen=True, eq=False)
class StoredFront:
    """A front as it is stored.

    Args:
        id: Its id.
        source: The source of its task.
        tours: The JSON of its tours, separated by commas, without brackets.
        places: Row and column of each place, for a front of a map.
    """

    id: str
    source: TaskSource
    tours: bytes
    places: Sequence[Sequence[int]] | None = None


@dataclass(frozen=True, eq=False)
class EarlierFront:
    """A front that is replanned.

    Args:
        labels: The names of its stops and objectives; without names, their numbers.
        sources: The source of the costs of each objective.
        ends: Whether its tours are closed, and the ends of open routes.
        start: The stop that closed tours are reported from.
        tours: The stops of each tour in order, shape (m, n), evenly spread over the front where
            it has more than MOST_TOURS.
        knee: The tour with the least sum of lengths, each in the front's own box, shape (n,).
        known: All tours of the front, shape (k, n).
        balances: Their balances, shape (k,).
    """

    labels: Labels
    sources: tuple[Source, ...]
    ends: RouteEnds
    start: int
    tours: NDArray[np.int64]
    knee: NDArray[np.int64]
    known: NDArray[np.int64]
    balances: Array

    @property
    def n(self) -> int:
        """The number of stops."""
        return len(self.labels.stops)

    def balance_of(self, tour: NDArray[np.int64]) -> float | None:
        """Return the balance of a tour in the front; None if the front does not have it."""
        same = (self.from_start(self.known) == self.from_start(tour[np.newaxis])).all(axis=1)
        return float(self.balances[same.argmax()]) if same.any() else None

    def from_start(self, tours: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return tours of the front's stops, shape (m, n); closed ones begin at their start."""
        if not self.ends.closed:
            return tours
        return rotated(tours, (tours == self.start).argmax(axis=1))


def read_earlier_front(stored: StoredFront, limits: Limits) -> EarlierFront:
    """Return the front that was stored.

    Raises:
        Refusal: It is of a kind that cannot be replanned, or cannot be read under these limits.
    """
    source = stored.source
    if source.kind not in _MODELS:
        reason = f"it is of POST /{source.kind}, and only those of POST /front and /coverage can be"
        raise not_replannable(stored.id, reason)
    try:
        model = _MODELS[source.kind]
        request = parse_front_request(source.body, limits, source.upload, model)
    except Refusal as refusal:
        raise refused_now(stored.id, refusal) from None
    start = request.start if isinstance(request.start, int) else 0
    front = with_tours(stored, request.n, lambda _: (request.ends, start))
    labels = request.labels or front.labels
    return replace(front, labels=labels, sources=_sources(request))


def with_tours(
    stored: StoredFront,
    n: int,
    ends_of: Callable[[NDArray[np.int64]], tuple[RouteEnds, int]],
) -> EarlierFront:
    """Return an earlier front with its tours, without sources; its stops are named by numbers.

    Args:
        stored: The front as it is stored.
        n: Its number of stops.
        ends_of: Returns the ends of all tours, and the stop that closed ones are reported from, by
            the first of them, shape (n,).

    Raises:
        Refusal: It has no tours, or tours with another number of stops.
    """
    tours, lengths = _read_tours(stored, n)
    chosen = np.linspace(0, len(tours) - 1, min(len(tours), MOST_TOURS)).astype(np.intp)
    ends, start = ends_of(tours[0])
    return EarlierFront(
        labels=_numbered(n),
        sources=(),
        ends=ends,
        start=start,
        tours=tours[chosen],
        knee=tours[knee(lengths)],
        known=tours,
        balances=balances(lengths),
    )


def refused_now(front: str, refusal: Refusal) -> Refusal:
    """Return the refusal of a front whose request is over the present limits."""
    return not_replannable(front, f"what it was planned from is refused now ({refusal.detail})")


def not_replannable(front: str, reason: str) -> Refusal:
    """Return the refusal of a front that cannot be replanned."""
    return Refusal("not-replannable", front=front, reason=reason)


def _read_tours(stored: StoredFront, n: int) -> tuple[NDArray[np.int64], Array]:
    """Return the stops of all tours, shape (m, n), and their lengths, shape (m, 2)."""
    read = _READ.findall(stored.tours)
    if not read:
        raise not_replannable(stored.id, "it has no tour")
    lengths, tours = (b",".join(texts) for texts in zip(*read, strict=True))
    # Reading numbers of one kind in this way takes a fifth of the time of reading lists.
    stops = np.fromstring(tours, np.int64, sep=",")
    if len(stops) != len(read) * n:
        raise not_replannable(stored.id, "its tours are not of its stops")
    return stops.reshape(-1, n), np.fromstring(lengths, sep=",").reshape(-1, OBJECTIVES)


def _numbered(n: int) -> Labels:
    """Return labels for stops and objectives without names."""
    stops = tuple(Stop(str(index)) for index in range(n))
    return Labels(stops, tuple(Objective(name) for name in _NAMES))


def _sources(request: FrontRequest) -> tuple[Source, ...]:
    if request.stops:
        return tuple(request.unmeasured.sources)
    if request.kind == "matrices":
        return tuple(Matrix(matrix) for matrix in request.matrices)
    planes = np.array(request.coordinates, np.float64)
    return tuple(Plane(planes[:, m : m + PLANE]) for m in range(0, planes.shape[1], PLANE))
