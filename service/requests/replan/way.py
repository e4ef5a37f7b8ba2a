"""The front that is replanned, and the rest of the way through its stops or places."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from paretour.choice import balances, knee

from service.coverage.coverage import Coverage
from service.errors import Refusal, invalid
from service.instance import CLOSED, RouteEnds
from service.objectives import NTH, OBJECTIVES, Objective
from service.replanning.earlier_tours import EarlierTours
from service.requests.replan.fields import ReplanRequest
from service.requests.stop_fields import find_index
from service.requests.stops import Hours, Labels, Source, Stop, Stops
from service.requests.task import Task
from service.search.open_routes import rotated

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
MOST_TOURS = 50  # of an earlier front to start the search from: the search has as many weights
_OF_FRONT = "a stop of the front"


class FoundTours(Protocol):
    """The tours of a front, as they are stored."""

    @property
    def orders(self) -> Indices:
        """The stops or places of each tour in order, shape (m, n)."""

    @property
    def lengths(self) -> Array:
        """The lengths of each tour, shape (k, m)."""

    def split(self) -> list[bytes]:
        """Return the JSON of each tour or plan."""

    @property
    def places(self) -> Sequence[Sequence[int]] | None:
        """Of a front of a map, row and column of each place."""


@dataclass(frozen=True, eq=False)
class StoredFront:
    """A front as it is stored: its id, the task that it was planned from, and its tours."""

    id: str
    task: bytes
    found: FoundTours


@dataclass(frozen=True, eq=False)
class ReplanSource:
    """A request to replan, as it came, and the stored front that it is about."""

    body: bytes
    front: StoredFront


@dataclass(frozen=True, eq=False)
class EarlierFront:
    """A front that is replanned.

    Args:
        labels: The names of its stops and objectives; their numbers, if it has no names.
        sources: The source of the costs of each objective; none of a front of a map.
        ends: Whether its tours are closed, and the ends of open routes.
        start: The stop that closed tours are reported from.
        tours: The stops of each tour in order, shape (m, n); closed tours begin at `start`.
        lengths: The lengths of each of the m tours under each objective.
        hours: When its tours began, if costs change over the day.
    """

    labels: Labels
    sources: Sequence[Source]
    ends: RouteEnds
    start: int
    tours: Indices
    lengths: Array
    hours: Hours | None = None

    @property
    def knee(self) -> Indices:
        """The tour with the least sum of lengths, each in the front's own box, shape (n,)."""
        return self.tours[knee(self.lengths)]

    @property
    def n(self) -> int:
        """The number of stops."""
        return len(self.labels.stops)

    @cached_property
    def ids(self) -> dict[str, int]:
        """The index of each stop by its id."""
        return {stop.id: index for index, stop in enumerate(self.labels.stops)}

    @property
    def first_and_last(self) -> tuple[int | None, int | None]:
        """The first stop of its tours, and the last one; None where it may be any."""
        return (self.start, self.start) if self.ends.closed else (self.ends.start, self.ends.end)

    def balance_of(self, tour: Indices) -> float | None:
        """Return the balance of a tour in the front.

        None if the front does not have it, or is of more than two objectives.
        """
        if self.lengths.shape[1] > OBJECTIVES:
            return None
        same = (self.tours == tour).all(axis=1)
        return float(balances(self.lengths)[same.argmax()]) if same.any() else None


def earlier_front(stored: StoredFront, task: Task, stops: Stops) -> EarlierFront:
    """Return the front of a task of stops.

    Raises:
        Refusal: It has no tours, or its tours are not of its stops.
    """
    tours, lengths = _tours(stored, stops.n), stored.found.lengths
    labels, start = task.labels or _numbered(stops.n), task.options.start
    if stops.ends.closed:
        tours = _from_stop(start, tours)
    return EarlierFront(labels, stops.sources, stops.ends, start, tours, lengths, stops.hours)


def earlier_front_of_map(stored: StoredFront, coverage: Coverage) -> EarlierFront:
    """Return the front of a coverage task, whose places are named by their indexes.

    Raises:
        Refusal: It has no tours, or its tours are not of its places.
    """
    n = len(stored.found.places or ())
    tours = _tours(stored, n)
    ends, start = CLOSED, int(tours[0, 0])
    if coverage.ends.closed:
        tours = _from_stop(start, tours)
    else:
        starts = coverage.start_pose is not None or coverage.ends.start is not None
        ends_there = coverage.end_pose is not None or coverage.ends.end is not None
        last = int(tours[0, -1])
        ends = RouteEnds(False, start if starts else None, last if ends_there else None)
    return EarlierFront(_numbered(n), (), ends, start, tours, stored.found.lengths)


def not_replannable(front: str, reason: str) -> Refusal:
    """Return the refusal of a front that cannot be replanned."""
    return Refusal("not-replannable", front=front, reason=reason)


def _tours(stored: StoredFront, n: int) -> Indices:
    """Return the tours of a front of n stops, shape (m, n)."""
    tours = stored.found.orders
    if not len(tours):
        raise not_replannable(stored.id, "it has no tour")
    if tours.shape[1] != n:
        raise not_replannable(stored.id, "its tours are not of its stops")
    return tours


def _from_stop(stop: int, tours: Indices) -> Indices:
    """Return closed tours, shape (m, n), each from the same stop on."""
    return rotated(tours, (tours == stop).argmax(axis=1))


def _numbered(n: int) -> Labels:
    """Return labels for stops and objectives without names."""
    stops = tuple(Stop(str(index)) for index in range(n))
    return Labels(stops, tuple(Objective(name) for name in NTH))


@dataclass(frozen=True, eq=False)
class RestOfWay:
    """The rest of a way, in indexes of all stops: those of a front, then new ones.

    Args:
        stops: Its stops, ascending, shape (k,).
        ends: Whether it leads back to its beginning, and its ends if it does not.
        start: The stop at which it goes on; None where any may be the first.
        begin: The index of that stop in the rest.
        ends_in_rest: The ends as indexes in the rest.
        done: The stops visited, in order.
        left: The front's stops among its own, without the ends.
    """

    stops: Indices
    ends: RouteEnds
    start: int | None
    begin: int | None
    ends_in_rest: RouteEnds
    done: tuple[int, ...]
    left: frozenset[int]

    def earlier_tours(
        self, front: EarlierFront, request: ReplanRequest, changed: Indices | None
    ) -> EarlierTours:
        """Return what is left of a front's tours, in indexes of the rest.

        Args:
            request: The request, which may name the tour that is being driven.
            changed: The stops to or from which costs have changed; None where that may be any.

        Raises:
            Refusal: The tour that is being driven does not have each stop of the front once.
        """
        driven = _driven_tour(front, request)
        tours, moved = _left_of_tours(front, driven, self)
        touched = None
        if changed is not None:
            stops = np.intersect1d(np.union1d(moved, changed), self.stops)
            touched = np.searchsorted(self.stops, stops)
        return EarlierTours(
            tours=np.searchsorted(self.stops, tours),
            min_kept=request.min_kept,
            touched=touched,
            balance=front.balance_of(driven),
        )


def rest_of_way(front: EarlierFront, request: ReplanRequest) -> RestOfWay:
    """Return the rest of the way through a front's stops.

    A closed tour leads back to its start, and an open route to its end if that is fixed. A fixed
    start counts as visited as soon as the position is another.

    Raises:
        Refusal: A stop is not known, named twice, done and removed, or needed as an end and done
            or removed; or no stop is left.
    """
    done = _indexes(request.done, front.ids, "done")
    removed = _indexes(request.remove, front.ids, "remove")
    begin, end = front.first_and_last
    start = _start(front, request, done[-1] if done else begin)
    for index, stop in enumerate(removed):
        if stop in done:
            raise invalid(f"remove/{index}", "visited", came=_name(front, stop))
        if stop in (start, end):
            code = "where-the-way-goes-on" if stop == start else "where-the-way-ends"
            raise invalid(f"remove/{index}", code, came=_name(front, stop))
    visited = {*done, *removed} if begin is None or start == begin else {*done, *removed, begin}
    left = frozenset(range(front.n)) - visited - {start, end}
    added = range(front.n, front.n + len(request.add))
    if not front.ends.closed and end is not None and (end == start or end in done):
        if left or added:
            part = f"done/{done.index(end)}" if end in done else "position"
            raise invalid(part, "ends-too-soon", came=_name(front, end))
        end = None
    chosen = {*left, *added} | {stop for stop in (start, end) if stop is not None}
    if not chosen:
        raise invalid("remove", "nothing-left")
    back = front.ends.closed and start == front.start
    ends = CLOSED if back else RouteEnds(False, start, end if end != start else None)
    stops = sorted(chosen)
    begin, *in_rest = (
        None if stop is None else stops.index(stop) for stop in (start, ends.start, ends.end)
    )
    return RestOfWay(
        stops=np.array(stops, np.int64),
        ends=ends,
        start=start,
        begin=begin,
        ends_in_rest=RouteEnds(back, *in_rest),
        done=done,
        left=left,
    )


def _start(front: EarlierFront, request: ReplanRequest, default: int | None) -> int | None:
    """Return the stop at which the way goes on, None where any may be the first."""
    if request.position is None:
        return default
    if isinstance(request.position, int | str):
        return find_index(request.position, front.ids, "position", front.n, _OF_FRONT)
    return front.n + len(request.add)  # a place of its own, after the added stops


def _left_of_tours(
    front: EarlierFront, driven: Indices, rest: RestOfWay
) -> tuple[Indices, Indices]:
    """Return what is left of the earlier tours, shape (m, k), and the stops with new neighbours.

    In indexes of all stops. The first row is what is left of the driven tour; of a large front's
    others there are MOST_TOURS, evenly spread. If more of the driven tour's last stops than of its
    first are done, it is driven the other way round. New neighbours are possible at the ends, and
    for stops beside one that has been removed.
    """
    driven = _as_driven(front, driven, rest.done)
    m = len(front.tours)
    spread = np.linspace(0, m - 1, min(m, MOST_TOURS)).astype(np.intp)
    tours = np.concatenate((driven[np.newaxis], front.tours[spread]))
    is_left = np.zeros(front.n, np.bool_)
    is_left[list(rest.left)] = True
    kept = tours[is_left[tours]].reshape(len(tours), -1)
    first = [] if rest.start is None else [rest.start]
    last = [] if rest.ends.end is None else [rest.ends.end]
    before, after = (np.tile(np.array(side, np.int64), (len(tours), 1)) for side in (first, last))
    beside = np.union1d(_beside_gone(tours, is_left), np.array([*first, *last], np.int64))
    return np.concatenate((before, kept, after), axis=1), beside


def _beside_gone(tours: Indices, is_left: NDArray[np.bool_]) -> Indices:
    """Return the remaining stops that are next to one that is gone in some tour, ascending."""
    gone = ~is_left[tours]
    beside = np.roll(gone, 1, axis=1) | np.roll(gone, -1, axis=1)
    return np.unique(tours[beside & ~gone])


def _driven_tour(front: EarlierFront, request: ReplanRequest) -> Indices:
    """Return the tour being driven, shape (n,): by default the front's knee."""
    if not request.tour:
        return front.knee
    stops = _indexes(request.tour, front.ids, "tour")
    if len(stops) != front.n:
        raise invalid("tour", "not-all-stops", stops=front.n, came=len(stops))
    tour = np.array(stops, np.int64)
    return _from_stop(front.start, tour[np.newaxis])[0] if front.ends.closed else tour


def _as_driven(front: EarlierFront, tour: Indices, done: Sequence[int]) -> Indices:
    """Return a tour in the direction in which it is driven, which the stops that are done show."""
    around = tour[::-1]
    if front.ends.closed:
        around = np.roll(around, 1)
    elif front.ends.start is not None or front.ends.end is not None:
        return tour
    forward, backward = (np.isin(each[: len(done)], done).sum() for each in (tour, around))
    return around if backward > forward else tour


def _indexes(references: Sequence[int | str], ids: Mapping[str, int], part: str) -> tuple[int, ...]:
    """Return the stops of a front that are named, each once."""
    found: dict[int, int] = {}
    for index, reference in enumerate(references):
        stop = find_index(reference, ids, f"{part}/{index}", len(ids), _OF_FRONT)
        if (other := found.setdefault(stop, index)) != index:
            values = {"other": f"/{part}/{other}", "came": reference}
            raise invalid(f"{part}/{index}", "named-twice", **values)
    return tuple(found)


def _name(front: EarlierFront, stop: int) -> str:
    return front.labels.stops[stop].id
