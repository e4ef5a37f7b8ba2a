"""Answers as immutable values with arrays."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import partial
from math import nan
from typing import Annotated, Any, TypeVar, Unpack

import numpy as np
from numpy.typing import NDArray
from paretour.choice import Choice, choose, losses
from paretour.described import (
    OF_MORE,
    OF_TWO,
    Array,
    Indexes,
    Lengths,
    Shape,
    answer,
    member,
    of_each,
)
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
    optional_column,
    read_only,
    read_rest,
    rows,
    text,
    value_of,
)
from paretour.fronts import StoredFront
from paretour.ros.paths import PAIR, Pairs, Path

FINAL_STATUSES = ("done", "cancelled", "failed")
MOST = 4  # objectives
# Sentences on members of fronts over maps.
PLACES = "row and column of each"
UNCOVERED = "the free cells that no path leads to, once the map is surveyed"
AnyFront = TypeVar("AnyFront", bound=StoredFront[Any])


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


@answer("FrontAnswer")
class Front(StoredFront[Tour]):
    """A front of tours, by ascending first length.

    Attributes with something of each tour are arrays, whose first dimension is k, or tuples.
    """

    items: Sequence[Tour] = member(named="front")
    places: Pairs | None = member(PLACES)
    uncovered: Uncovered | None = member(UNCOVERED)
    tours: NDArray[np.int64] = of_each("tour", Tour)
    angles: Array = of_each("angle", Tour)
    balances: Array = of_each("balance", Tour)
    paths: tuple[Path, ...] | None = of_each("path", Tour)
    stops: tuple[tuple[str, ...], ...] | None = of_each("stops", Tour)
    kept: Array | None = of_each("kept", Tour)
    arrivals: tuple[Array, ...] | None = of_each("arrivals", Tour)
    departures: Array | None = of_each("departure", Tour)
    times: Array | None = of_each("times", Tour)
    means: Array | None = of_each("means", Tour)
    p90: Array | None = of_each("p90", Tour)

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


class _Tours(Sequence[Tour]):
    """The tours of a front, each made when it is asked for of what the front has of all."""

    def __init__(self, front: str, columns: Mapping[str, Any]) -> None:
        self._front, self._columns = front, columns

    def __len__(self) -> int:
        return len(self._columns["lengths"])

    def __getitem__(self, number: Any) -> Any:
        columns = self._columns.items()
        row = {of: None if each is None else each[number] for of, each in columns}
        plain = {of: float(value) for of, value in row.items() if isinstance(value, np.float64)}
        return Tour(front=self._front, **{**row, **plain})


def parse_front(document: Mapping[str, Any]) -> Front:
    """Return the front in a JSON answer.

    Raises:
        UnexpectedAnswer: A member is missing or wrong; so do the functions below.
    """
    answer = members(document, "answer")
    cities, items = answer.read("cities", count), answer.read("front", each(members))
    m = objective_count(answer, items)
    all_fields = ((field.name, field.metadata.get("of_each")) for field in fields(Front))
    of = {name: each for name, each in all_fields if each}
    none = read_only(np.full(len(items), nan))
    columns: dict[str, Any] = {
        "tours": rows(items, "tour", partial(indexes, below=cities), cities),
        "lengths": rows(items, "lengths", floats, m),
        "angles": column(items, "angle") if m == PAIR else none,
        "balances": column(items, "balance") if m == PAIR else none,
    }
    sizes = {"tour": range(cities), "lengths": range(m)}
    rest = {name: each for name, each in of.items() if name not in columns}
    columns |= {name: optional_column(items, Tour, each, sizes) for name, each in rest.items()}
    of_tours = {of[name]: values for name, values in columns.items()}
    of_tours["losses"] = losses(columns["lengths"]) if m > PAIR else None
    known = {**columns, "items": _Tours(answer.read("id", text), of_tours)}
    return read_front(Front, answer, known, places=indexes(cities, PAIR))


def parse_tour(document: Mapping[str, Any]) -> Tour:
    """Return the tour in a JSON answer."""
    return value_of(Tour)(document, "answer")


def objective_count(answer: Members, items: Sequence[Members]) -> int:
    """Return the number of objectives: of lengths of the first item, or else of the scale."""
    lengths = items[0].document.get("lengths") if items else answer.document.get("scale")
    few = isinstance(lengths, list) and PAIR <= len(lengths) <= MOST
    return len(lengths) if few else PAIR


def read_front(
    cls: type[AnyFront], answer: Members, known: Mapping[str, Any], **own: Read[Any]
) -> AnyFront:
    """Return a front of any kind of an answer; `known` is read, and `own` are as of `value_of`."""
    own["actor"] = lambda value, where: members(value, where).read("name", text)
    for name in ("reference_point", "scale", "driven"):
        own[name] = floats(known["lengths"].shape[1])
    return read_rest(cls, answer, {**known, "document": answer.document}, **own)
