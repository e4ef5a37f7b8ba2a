"""Answers as immutable values with arrays."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import nan
from typing import Any, TypeVar, Unpack

import numpy as np
from numpy.typing import NDArray
from paretour.choice import Choice, choose
from paretour.display import counted, numbers
from paretour.expect import (
    Members,
    Read,
    column,
    count,
    each,
    floats,
    indexes,
    members,
    number,
    read_only,
    rows,
    text,
    value_of,
)
from paretour.fronts import Array, Objective, RequestNote, StoredFront
from paretour.ros.paths import PAIR, Path

T = TypeVar("T")
FINAL_STATUSES = ("done", "cancelled", "failed")
MOST = 4  # objectives


@dataclass(frozen=True, kw_only=True)
class Progress:
    """The hypervolume and the number of points of a job, `seconds` after its search began."""

    seconds: float
    hypervolume: float
    points: int


@dataclass(frozen=True, kw_only=True)
class UncoveredRegion:
    """A region of free cells that no path leads to.

    Attributes:
        cells: How many cells it has.
        cell: The row and column of one of them.
        box: The row and column of the first and of the last cell of its bounding box.
    """

    cells: int
    cell: tuple[int, int]
    box: tuple[tuple[int, int], tuple[int, int]]


@dataclass(frozen=True, kw_only=True)
class Uncovered:
    """The free cells of a map that no path leads to, such as a closed room.

    Attributes:
        cells: How many there are.
        square_metres: Their area.
        regions: The largest regions that they form, at most 20, the largest first.
    """

    cells: int
    square_metres: float
    regions: tuple[UncoveredRegion, ...]


def _of_lengths(tour: Mapping[str, Any]) -> Any:
    return floats(len(tour["lengths"]))


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Tour:
    """A tour of a front.

    Attributes:
        front: The id of the front.
        angle: The direction of its lengths in objective space, in degrees; NaN of more than two
            objectives.
        balance: 0 at the least first length of the front, 1 at the least second; NaN of more.
        lengths: Its length under each objective, shape (m,).
        tour: Its cities, or over a map its places, in order, shape (n,).
        arrivals: All its lengths up to each city, and back at the first if it is closed, shape (n
            + 1, m); None if the request did not ask for them.
        path: Its path over a map, if the request asked for paths.
        stops: The ids of its stops in order, if the request had ids.
        kept: The share of the driven tour's remaining legs that it keeps, if it was replanned.
        departure: Over the day, when it begins, in seconds of the day.
        times: Over the day, when it reaches each city, and when it ends, shape (n + 1,).
        means: Where costs spread, its mean lengths, shape (m,).
        p90: Where costs spread, the lengths that nine days of ten do not exceed, shape (m,).
    """

    front: str
    angle: float = nan
    balance: float = nan
    lengths: Array
    tour: NDArray[np.int64]
    arrivals: Array | None = field(
        metadata={"read": lambda tour: floats(None, len(tour["lengths"]))}
    )
    path: Path | None
    stops: tuple[str, ...] | None = field(
        default=None, metadata={"read": lambda tour: each(text, len(tour["tour"]))}
    )
    kept: float | None = None
    departure: float | None = None
    times: Array | None = field(
        default=None, metadata={"read": lambda tour: floats(len(tour["tour"]) + 1)}
    )
    means: Array | None = field(default=None, metadata={"read": _of_lengths})
    p90: Array | None = field(default=None, metadata={"read": _of_lengths})

    def __repr__(self) -> str:
        return f"<Tour of {len(self.tour)} cities: lengths {numbers(self.lengths)}>"


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Front(StoredFront[Tour]):
    """The tours of a front, in order of their first length.

    Attributes:
        tours: The cities of each tour in order, shape (k, n).
        angles: The direction of the lengths of each tour, in degrees, shape (k,); NaN of more than
            two objectives.
        balances: 0 at the least first length of the tours, 1 at the least second, shape (k,); NaN
            of more than two objectives.
        hypervolume_bound: The most that any front can have, if a bound was asked for.
        scale: The length that is 1 in scaled objectives, shape (m,); None while it is not known.
        actor: The name of the network; None where it built no tours.
        places: Over a map, the row and column of each city, shape (n, 2).
        paths: Over a map, the path of each tour, if the request asked for paths.
        stops: The ids of the stops of each tour in order, if the request had ids.
        kept: The share of the driven tour's remaining legs that each tour keeps, shape (k,), if it
            was replanned.
        arrivals: All lengths of each tour up to each of its cities, if the request asked for them.
        uncovered: Over a map, the free cells that no path leads to.
        departures: Over the day, when each tour begins, in seconds of the day, shape (k,).
        times: Over the day, when each reaches each city, and when it ends, shape (k, n + 1).
        means: Where costs spread, the mean lengths of each tour, shape (k, m).
        p90: Where costs spread, the lengths that nine days of ten do not exceed, shape (k, m).
    """

    tours: NDArray[np.int64]
    angles: Array
    balances: Array
    hypervolume_bound: float | None
    scale: Array | None
    actor: str | None
    places: NDArray[np.int64] | None
    paths: tuple[Path, ...] | None
    stops: tuple[tuple[str, ...], ...] | None = None
    kept: Array | None = None
    arrivals: tuple[Array, ...] | None = None
    uncovered: Uncovered | None = None
    departures: Array | None = None
    times: Array | None = None
    means: Array | None = None
    p90: Array | None = None

    def nearest(self, angle: float) -> Tour:
        """Return the tour whose direction is nearest to an angle in degrees.

        Raises:
            ValueError: The front is still empty.
        """
        return self.choose(angle)

    def choose(self, angle: float | None = None, **choice: Unpack[Choice]) -> Tour:
        """Return one tour: at an angle or balance, by weights, within budgets, or the knee.

        Raises:
            ValueError: Not exactly one way to choose is given, it does not fit the objectives, no
                tour is within the budgets, or the front is still empty.
        """
        names = self.names if self.objectives else ()
        return self[choose(self.lengths, self.angles, names, {"angle": angle, **choice})]

    def _item(self, number: int) -> Tour:
        return Tour(
            front=self.id,
            angle=float(self.angles[number]),
            balance=float(self.balances[number]),
            lengths=self.lengths[number],
            tour=self.tours[number],
            arrivals=None if self.arrivals is None else self.arrivals[number],
            path=None if self.paths is None else self.paths[number],
            stops=None if self.stops is None else self.stops[number],
            kept=None if self.kept is None else float(self.kept[number]),
            departure=None if self.departures is None else float(self.departures[number]),
            times=None if self.times is None else self.times[number],
            means=None if self.means is None else self.means[number],
            p90=None if self.p90 is None else self.p90[number],
        )

    def _counted(self) -> str:
        return f"{counted(len(self), 'tour')} of {self.tours.shape[1]} cities"

    @property
    def X(self) -> NDArray[np.int64]:  # noqa: N802
        """The tours, shape (k, n), by the name that pymoo has for solutions."""
        return self.tours

    def _columns(self) -> dict[str, Sequence[Any]]:
        found: dict[str, Sequence[Any]] = {}
        if self.lengths.shape[1] == PAIR:
            found |= {"balance": self.balances.tolist(), "angle": self.angles.tolist()}
        if self.kept is not None:
            found["kept"] = self.kept.tolist()
        if self.departures is not None:
            found["departure"] = self.departures.tolist()
        return {**found, "tour": list(self.stops or map(tuple, self.tours.tolist()))}


def parse_front(document: Mapping[str, Any]) -> Front:
    """Return the front in a JSON answer.

    Raises:
        UnexpectedAnswer: A member is missing or wrong; so do the functions below.
    """
    answer = members(document, "answer")
    cities = answer.read("cities", count)
    items = answer.read("front", each(members))
    actor = answer.maybe("actor", members)
    named = answer.maybe("stops", each(members, cities)) is not None
    m = _objective_count(answer, items)
    return Front(
        **stored_members(answer, items),
        tours=rows(items, "tour", partial(indexes, below=cities), cities),
        angles=_of_two_each(items, "angle", m),
        balances=_of_two_each(items, "balance", m),
        hypervolume_bound=answer.maybe("hypervolume_bound", number),
        scale=answer.maybe("scale", floats(m)),
        actor=None if actor is None else actor.read("name", text),
        places=answer.maybe("places", indexes(cities, PAIR)),
        paths=of_all(items, "path", value_of(Path)),
        stops=tuple(item.read("stops", each(text, cities)) for item in items) if named else None,
        objectives=objectives_of(answer),
        kept=column(items, "kept") if _have(items, "kept") else None,
        arrivals=of_all(items, "arrivals", floats(None, m)),
        uncovered=answer.maybe("uncovered", value_of(Uncovered)),
        departures=column(items, "departure") if _have(items, "departure") else None,
        times=rows(items, "times", floats, cities + 1) if _have(items, "times") else None,
        means=rows(items, "means", floats, m) if _have(items, "means") else None,
        p90=rows(items, "p90", floats, m) if _have(items, "p90") else None,
    )


def parse_tour(document: Mapping[str, Any]) -> Tour:
    """Return the tour in a JSON answer."""
    return value_of(Tour)(document, "answer")


def _objective_count(answer: Members, items: Sequence[Members]) -> int:
    """Return the number of objectives: of lengths of the first item, or else of the scale."""
    lengths = items[0].document.get("lengths") if items else answer.document.get("scale")
    few = isinstance(lengths, list) and PAIR <= len(lengths) <= MOST
    return len(lengths) if few else PAIR


def _of_two_each(items: Sequence[Members], name: str, objectives: int) -> Array:
    """Return a number that tours have under two objectives, shape (k,); NaN under more."""
    if objectives == PAIR:
        return column(items, name)
    return read_only(np.full(len(items), nan))


def of_all(items: Sequence[Members], name: str, read: Read[T]) -> tuple[T, ...] | None:
    """Return a member of all items, or None if the first has none."""
    return tuple(item.read(name, read) for item in items) if _have(items, name) else None


def _have(items: Sequence[Members], name: str) -> bool:
    """Return whether the first item has a member."""
    return bool(items) and items[0].document.get(name) is not None


def stored_members(answer: Members, items: Sequence[Members]) -> dict[str, Any]:
    """Return the attributes that fronts of all kinds have, from an answer and its items."""
    m = _objective_count(answer, items)
    return {
        "id": answer.read("id", text),
        "status": answer.read("status", text),
        "lengths": rows(items, "lengths", floats, m),
        "points": answer.read("points", count),
        "hypervolume": answer.read("hypervolume", number),
        "reference_point": answer.maybe("reference_point", floats(m)),
        "terminated": answer.maybe("terminated", text),
        "document": answer.document,
        "notes": answer.maybe("notes", each(value_of(RequestNote))) or (),
    }


def objectives_of(answer: Members) -> tuple[Objective, ...] | None:
    """Return the objectives of an answer, where the request named them."""
    return answer.maybe("objectives", each(value_of(Objective)))
