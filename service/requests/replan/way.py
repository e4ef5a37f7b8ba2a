"""The rest of a way: where it continues, through which stops, and where it ends."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.errors import invalid
from service.instance import CLOSED, RouteEnds
from service.replanning.earlier_tours import EarlierTours
from service.requests.replan.costs import AllStops
from service.requests.replan.earlier_front import EarlierFront
from service.requests.replan.fields import ReplanRequest
from service.requests.stop_fields import find_index
from service.requests.validation import show

Tours = NDArray[np.int64]
MOST_TOURS = 50  # of an earlier front to start the search from: the search has as many weights
_OF_FRONT = "a stop of the front"


@dataclass(frozen=True, eq=False)
class RestOfWay:
    """The rest of a way, in indexes of all stops: those of a front, then new ones.

    Args:
        stops: Its stops, ascending, shape (k,).
        ends: Whether it leads back to its beginning, and its ends if it does not.
        start: The stop at which it continues; None where any may be the first.
        done: The stops visited, in order.
        left: Those of its stops that are the front's, without the ends.
    """

    stops: NDArray[np.int64]
    ends: RouteEnds
    start: int | None
    done: tuple[int, ...]
    left: frozenset[int]

    def place(self, stop: int | None) -> int | None:
        """Return the index in the rest of one of its stops."""
        return None if stop is None else int(np.searchsorted(self.stops, stop))

    @property
    def ends_in_rest(self) -> RouteEnds:
        """The ends as indexes in the rest."""
        closed, start, end = self.ends
        return RouteEnds(closed, self.place(start), self.place(end))

    def earlier_tours(
        self, front: EarlierFront, request: ReplanRequest, changed: NDArray[np.int64] | None
    ) -> EarlierTours:
        """Return what is left of a front's tours, in indexes of the rest.

        Args:
            front: The front.
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


def rest_of_way(front: EarlierFront, request: ReplanRequest, stops: AllStops) -> RestOfWay:
    """Return what is left of the way through a front's stops.

    A closed tour leads back to its start, and an open route to its end if that is fixed. A fixed
    start counts as visited as soon as the position is another.

    Raises:
        Refusal: A stop is not known, named twice, done and removed, or needed as an end and done
            or removed; or no stop is left.
    """
    ids = {stop.id: index for index, stop in enumerate(front.labels.stops)}
    done = _indexes(request.done, ids, "done")
    removed = _indexes(request.remove, ids, "remove")
    begin, end = _ends(front)
    start = _start(request, ids, stops, done[-1] if done else begin)
    for index, stop in enumerate(removed):
        if stop in done:
            raise invalid(f"remove/{index}", f"must not be done, got {show(_name(front, stop))}")
        if stop in (start, end):
            where = "goes on" if stop == start else "ends"
            demand = f"must not be where the way {where}, got {show(_name(front, stop))}"
            raise invalid(f"remove/{index}", demand)
    visited = {*done, *removed} if begin is None or start == begin else {*done, *removed, begin}
    left = frozenset(range(front.n)) - visited - {start, end}
    added = range(front.n, front.n + len(request.add))
    if not front.ends.closed and end is not None and (end == start or end in done):
        if left or added:
            part = f"done/{done.index(end)}" if end in done else "position"
            demand = "must not be where the way ends while stops are left"
            raise invalid(part, f"{demand}, got {show(_name(front, end))}")
        end = None
    chosen = {*left, *added} | {stop for stop in (start, end) if stop is not None}
    if not chosen:
        raise invalid("remove", "must leave a stop to visit, and leaves none")
    back = front.ends.closed and start == front.start
    ends = CLOSED if back else RouteEnds(False, start, end if end != start else None)
    return RestOfWay(np.array(sorted(chosen), np.int64), ends, start, done, left)


def _left_of_tours(
    front: EarlierFront, driven: NDArray[np.int64], rest: RestOfWay
) -> tuple[Tours, NDArray[np.int64]]:
    """Return what is left of the earlier tours, shape (m, k), and the stops with new neighbours.

    In indexes of all stops. The first row is what is left of the driven tour; of a large front's
    others there are MOST_TOURS, evenly spread. If more of the driven tour's last stops than of its
    first are done, it is driven the other way round. New neighbours are possible at the ends, and
    for stops beside one that is no longer in a tour.
    """
    [driven] = front.from_start(driven[np.newaxis])
    driven = _as_driven(front, driven, rest.done)
    m = len(front.tours)
    spread = np.linspace(0, m - 1, min(m, MOST_TOURS)).astype(np.intp)
    tours = np.concatenate((driven[np.newaxis], front.from_start(front.tours[spread])))
    is_left = np.zeros(front.n, np.bool_)
    is_left[list(rest.left)] = True
    kept = tours[is_left[tours]].reshape(len(tours), -1)
    first = [] if rest.start is None else [rest.start]
    last = [] if rest.ends.end is None else [rest.ends.end]
    before, after = (np.tile(np.array(side, np.int64), (len(tours), 1)) for side in (first, last))
    beside = np.union1d(_beside_gone(tours, is_left), np.array([*first, *last], np.int64))
    return np.concatenate((before, kept, after), axis=1), beside


def _beside_gone(tours: Tours, is_left: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the remaining stops that are beside a gone one in some tour, ascending."""
    gone = ~is_left[tours]
    beside = np.roll(gone, 1, axis=1) | np.roll(gone, -1, axis=1)
    return np.unique(tours[beside & ~gone])


def _ends(front: EarlierFront) -> tuple[int | None, int | None]:
    """Return the first and the last stop of a front's tours; None where it may be any."""
    if front.ends.closed:
        return front.start, front.start
    return front.ends.start, front.ends.end


def _start(
    request: ReplanRequest, ids: Mapping[str, int], stops: AllStops, default: int | None
) -> int | None:
    """Return the stop at which the way goes on, None where any may be the first."""
    if request.position is None:
        return default
    if not isinstance(request.position, int | str):
        return len(stops.stops) - 1
    return find_index(request.position, ids, "position", len(ids), _OF_FRONT)


def _driven_tour(front: EarlierFront, request: ReplanRequest) -> NDArray[np.int64]:
    """Return the tour being driven, shape (n,): by default the front's knee.

    Raises:
        Refusal: It does not have each stop of the front once.
    """
    if not request.tour:
        return front.knee
    ids = {stop.id: index for index, stop in enumerate(front.labels.stops)}
    tour = _indexes(request.tour, ids, "tour")
    if len(tour) != front.n:
        raise invalid("tour", f"must have all {front.n} stops of the front, got {len(tour)}")
    return np.array(tour, np.int64)


def _as_driven(
    front: EarlierFront, tour: NDArray[np.int64], done: Sequence[int]
) -> NDArray[np.int64]:
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
            demand = f"must not be {part}/{other} again, got {show(reference)}"
            raise invalid(f"{part}/{index}", demand)
    return tuple(found)


def _name(front: EarlierFront, stop: int) -> str:
    return front.labels.stops[stop].id
