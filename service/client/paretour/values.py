"""Answers as immutable values with arrays."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import nan
from typing import Annotated, Any, Unpack

import numpy as np
from numpy.typing import NDArray
from paretour.choice import Choice, choose
from paretour.described import OF_MORE, OF_TWO, Array, Indexes, Lengths, Shape, answer, member
from paretour.display import counted, numbers
from paretour.expect import (
    Members,
    column,
    count,
    each,
    floats,
    indexes,
    members,
    number,
    optional_column,
    read_only,
    rows,
    text,
    value_of,
)
from paretour.fronts import Objective, RequestNote, StoredFront
from paretour.ros.paths import PAIR, Path

FINAL_STATUSES = ("done", "cancelled", "failed")
MOST = 4  # objectives
# The attributes of a front that have a member of each of its tours.
_COLUMNS = {
    "tours": "tour",
    "angles": "angle",
    "balances": "balance",
    "paths": "path",
    "departures": "departure",
    **{name: name for name in ("stops", "kept", "arrivals", "times", "means", "p90")},
}


@dataclass(frozen=True, kw_only=True)
class Progress:
    """The hypervolume and the number of points of a job, `seconds` after its search began."""

    seconds: float
    hypervolume: float
    points: int


@answer("ActorName", eq=True)
class ActorName:
    """The network that built a front."""

    name: str
    digest: str = member("SHA-256 of its file, or of its package's name and version")


@answer("ActorItem", eq=True)
class Actor(ActorName):
    """A network, as its file describes it."""

    commit: str = member("the commit of the source that exported it")
    inputs: str = member("the kind of instance that it reads")
    sizes: Any = member("numbers of cities that it was trained on")
    angles: Any = member("angles that it was trained on")
    config: Any = member("the configuration of its training")
    figures: Any = member("what was measured of it")
    repairs: bool = member("whether it can repair its tours", default=False, always=True)
    most_objectives: int = member("the most objectives that it takes", default=2, always=True)


@answer("UncoveredRegionItem", eq=True)
class UncoveredRegion:
    """A region of free cells that no path leads to."""

    cells: int = member("how many cells it has")
    cell: tuple[int, int] = member("row and column of a cell in it")
    box: tuple[tuple[int, int], tuple[int, int]] = member(
        "row and column of the first and of the last cell of its bounding box"
    )


@answer("UncoveredItem", eq=True)
class Uncovered:
    """The free cells that no path leads to, as a room that is closed off."""

    cells: int = member("how many there are")
    square_metres: float = member("their area")
    regions: tuple[UncoveredRegion, ...] = member("the largest, at most 20, the largest first")


@answer("TourItem")
class TourItem:
    """A tour and where it stands."""

    angle: float = member(
        "of two objectives: direction of the scaled lengths, in degrees", default=nan
    )
    balance: float = member(OF_TWO, default=nan)
    losses: Lengths | None = member(OF_MORE, default=None)
    kept: float | None = member(
        "only in a front that was replanned: the share of the driven tour's remaining legs that"
        " this tour keeps, in either direction if costs are symmetric",
        default=None,
    )
    departure: float | None = member(
        "where costs change over the day: when the tour begins, in seconds of the day",
        default=None,
    )
    lengths: Lengths = member("its length under each objective")
    means: Lengths | None = member(
        "where costs spread: the mean lengths; those in `lengths` may be percentiles", default=None
    )
    p90: Lengths | None = member(
        "where costs spread: the lengths that nine days of ten do not exceed", default=None
    )
    tour: Indexes = member("its cities, or over a map its places, in order")
    arrivals: Annotated[Array, Shape(None, "lengths")] | None = member(
        "only if `arrivals` is true: all lengths up to each stop, and up to the return of a closed"
        " tour"
    )
    times: Annotated[Array, Shape("tour", more=1)] | None = member(
        "where costs change over the day: when it reaches each stop, in seconds of the day, and"
        " when it ends",
        default=None,
    )
    stops: Annotated[tuple[str, ...], Shape("tour")] | None = member(
        "the ids of its stops, if the request has ids", default=None
    )


@answer("CoverageItem")
class CoverageItem(TourItem):
    """A tour through places on a map."""

    path: Path | None = member("if `paths` is true")


@answer("TourAnswer")
class Tour(CoverageItem):
    """A tour of a front."""

    front: str = member("the front's id")

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
        known = {of: getattr(self, name) for name, of in _COLUMNS.items()}
        if self.lengths.shape[1] > PAIR:
            known["losses"] = self.losses
        row = {of: None if column is None else column[number] for of, column in known.items()}
        plain = {of: float(value) for of, value in row.items() if isinstance(value, np.float64)}
        return Tour(front=self.id, lengths=self.lengths[number], **{**row, **plain})

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
    answer.maybe("stops", each(members, cities))  # its tours have their ids
    m = _objective_count(answer, items)
    return Front(
        **stored_members(answer, items),
        tours=rows(items, "tour", partial(indexes, below=cities), cities),
        angles=column(items, "angle") if m == PAIR else _no_numbers(items),
        balances=column(items, "balance") if m == PAIR else _no_numbers(items),
        hypervolume_bound=answer.maybe("hypervolume_bound", number),
        scale=answer.maybe("scale", floats(m)),
        actor=None if actor is None else actor.read("name", text),
        places=answer.maybe("places", indexes(cities, PAIR)),
        objectives=objectives_of(answer),
        uncovered=answer.maybe("uncovered", value_of(Uncovered)),
        **{
            name: optional_column(items, Tour, of, {"tour": range(cities), "lengths": range(m)})
            for name, of in _COLUMNS.items()
            if name not in ("tours", "angles", "balances")
        },
    )


def parse_tour(document: Mapping[str, Any]) -> Tour:
    """Return the tour in a JSON answer."""
    return value_of(Tour)(document, "answer")


def _objective_count(answer: Members, items: Sequence[Members]) -> int:
    """Return the number of objectives: of lengths of the first item, or else of the scale."""
    lengths = items[0].document.get("lengths") if items else answer.document.get("scale")
    few = isinstance(lengths, list) and PAIR <= len(lengths) <= MOST
    return len(lengths) if few else PAIR


def _no_numbers(items: Sequence[Members]) -> Array:
    """Return NaN for each item."""
    return read_only(np.full(len(items), nan))


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
