"""Answers as immutable values with arrays."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, TypeVar, Unpack

import numpy as np
from numpy.typing import NDArray
from paretour.choice import Choice, choose

Array = NDArray[np.float64]
AnyArray = TypeVar("AnyArray", bound=NDArray[Any])
FINAL_STATUSES = ("done", "cancelled", "failed")
Status = Literal["queued", "running", "done", "cancelled", "failed"]


@dataclass(frozen=True, kw_only=True)
class Progress:
    """The hypervolume and the number of points of a job, `seconds` after its search began."""

    seconds: float
    hypervolume: float
    points: int


@dataclass(frozen=True)
class Objective:
    """An objective as the request named it, and its unit or None."""

    name: str
    unit: str | None


@dataclass(frozen=True, eq=False)
class Path:
    """The way of a tour over a map, and its length.

    Attributes:
        cells: Rows and columns, shape (m, 2), from the first place back to it; of an
            open route to the last place.
        metres: The length.
        points: x and y of each cell's middle in the frame of the map, in metres, shape (m, 2);
            None where its origin is not known.
    """

    cells: NDArray[np.int64]
    metres: float
    points: Array | None = None


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
    """The free cells of a map that no path leads to, as a room that is closed off.

    Attributes:
        cells: How many there are.
        square_metres: Their area.
        regions: The largest regions that they form, at most 20, the largest first.
    """

    cells: int
    square_metres: float
    regions: tuple[UncoveredRegion, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Tour:
    """A tour of a front.

    Attributes:
        front: The id of the front.
        angle: The direction of its lengths in objective space, in degrees.
        balance: 0 at the least first length of the front, 1 at the least second.
        lengths: Its length under each objective, shape (2,).
        tour: Its cities, or over a map its places, in order, shape (n,).
        arrivals: Both its lengths up to each city, and back at the first where it is closed, shape
            (n + 1, 2); None where the request did not ask for them.
        path: Its way over a map, where the request asked for paths.
        stops: The ids of its stops in order, where the request had ids.
        kept: The share of the driven tour's remaining legs that it keeps, where it was replanned.
    """

    front: str
    angle: float
    balance: float
    lengths: Array
    tour: NDArray[np.int64]
    arrivals: Array | None
    path: Path | None
    stops: tuple[str, ...] | None = None
    kept: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Front:
    """The tours of a front, in order of their first length.

    Attributes:
        id: The id under which the service stores the front.
        status: The status of its job.
        tours: The cities of each tour in order, shape (m, n).
        lengths: The lengths of each tour, shape (m, 2).
        angles: The direction of the lengths of each tour, in degrees, shape (m,).
        balances: 0 at the least first length of the tours, 1 at the least second, shape (m,).
        points: The number of nondominated tours found, of which these are returned.
        hypervolume: The share of the box at the reference point that the points found dominate.
        hypervolume_bound: The most that any front can have, where a bound was asked for.
        reference_point: The reference point of the hypervolume, shape (2,).
        scale: The length that is 1 in scaled objectives, shape (2,).
        actor: The name of the network; None where it built no tours.
        terminated: Why the search ended; None while it runs. `converged` proves that nothing is
            better only up to nine cities.
        places: Over a map, the row and column of each city, shape (n, 2).
        paths: Over a map, the way of each tour, where the request asked for paths.
        document: The answer as it came, with every member.
        stops: The ids of the stops of each tour in order, where the request had ids.
        objectives: Both objectives, where the request named them.
        kept: The share of the driven tour's remaining legs that each tour keeps, shape (m,), where
            it was replanned.
        uncovered: Over a map, the free cells that no path leads to.
    """

    id: str
    status: Status
    tours: NDArray[np.int64]
    lengths: Array
    angles: Array
    balances: Array
    points: int
    hypervolume: float
    hypervolume_bound: float | None
    reference_point: Array
    scale: Array
    actor: str | None
    terminated: Literal["converged", "time_limit", "cancelled"] | None
    places: NDArray[np.int64] | None
    paths: tuple[Path, ...] | None
    document: Mapping[str, Any]
    stops: tuple[tuple[str, ...], ...] | None = None
    objectives: tuple[Objective, ...] | None = None
    kept: Array | None = None
    uncovered: Uncovered | None = None

    def nearest(self, angle: float) -> Tour:
        """Return the tour whose direction is nearest to an angle in degrees.

        Raises:
            ValueError: The front is still empty.
        """
        return self.choose(angle)

    def choose(self, angle: float | None = None, **choice: Unpack[Choice]) -> Tour:
        """Return one tour: at an angle in degrees, at a balance, within a budget, or the knee.

        Raises:
            ValueError: Not exactly one way to choose is given, no tour is within the budget, or
                the front is still empty.
        """
        index = choose(self.lengths, self.angles, angle, choice)
        return Tour(
            front=self.id,
            angle=float(self.angles[index]),
            balance=float(self.balances[index]),
            lengths=self.lengths[index],
            tour=self.tours[index],
            arrivals=_arrivals(self.document["front"][index]),
            path=None if self.paths is None else self.paths[index],
            stops=None if self.stops is None else self.stops[index],
            kept=None if self.kept is None else float(self.kept[index]),
        )


@dataclass(frozen=True, kw_only=True)
class Actor:
    """A network that the service has loaded.

    Attributes:
        name: The name to choose it by.
        digest: The SHA-256 of its file.
        inputs: The kind of instance that it reads, `coordinates` or `matrices`.
        commit: The commit of the source that exported it.
        sizes: The least and the most cities that it was trained on.
        angles: The least and the greatest angle that it was trained on, in degrees.
        config: The configuration of its training.
        figures: Its hypervolumes, as measured at export.
        repairs: Whether it can repair its tours.
    """

    name: str
    digest: str
    inputs: str
    commit: str
    sizes: Any
    angles: Any
    config: Any
    figures: Any
    repairs: bool = False


def parse_actor(document: Mapping[str, Any]) -> Actor:
    """Return the actor in a JSON answer, of which members that are not known are left out."""
    known = {field.name for field in fields(Actor)}
    return Actor(**{name: value for name, value in document.items() if name in known})


def parse_front(document: Mapping[str, Any]) -> Front:
    """Return the front in a JSON answer."""
    items: Sequence[Mapping[str, Any]] = document["front"]
    tours = read_only_integers([item["tour"] for item in items])
    paths = tuple(path for item in items if (path := parse_path(item)) is not None)
    return Front(
        id=document["id"],
        status=document["status"],
        tours=tours.reshape(len(items), document["cities"]),
        lengths=read_only_floats([item["lengths"] for item in items]).reshape(-1, 2),
        angles=read_only_floats([item["angle"] for item in items]),
        balances=read_only_floats([item["balance"] for item in items]),
        points=document["points"],
        hypervolume=document["hypervolume"],
        hypervolume_bound=document["hypervolume_bound"],
        reference_point=read_only_floats(document["reference_point"]),
        scale=read_only_floats(document["scale"]),
        actor=(document["actor"] or {}).get("name"),
        terminated=document["terminated"],
        places=read_only_integers(document["places"]) if "places" in document else None,
        paths=paths or None,
        document=document,
        stops=tuple(tuple(item["stops"]) for item in items) if "stops" in document else None,
        objectives=objectives_of(document),
        kept=read_only_floats([item["kept"] for item in items]) if _is_replanned(items) else None,
        uncovered=parse_uncovered(document),
    )


def parse_tour(document: Mapping[str, Any]) -> Tour:
    """Return the tour in a JSON answer."""
    return Tour(
        front=document["front"],
        angle=document["angle"],
        balance=document["balance"],
        lengths=read_only_floats(document["lengths"]),
        tour=read_only_integers(document["tour"]),
        arrivals=_arrivals(document),
        path=parse_path(document),
        stops=tuple(document["stops"]) if "stops" in document else None,
        kept=document.get("kept"),
    )


def _is_replanned(items: Sequence[Mapping[str, Any]]) -> bool:
    return bool(items) and "kept" in items[0]


def _arrivals(item: Mapping[str, Any]) -> Array | None:
    return read_only_floats(item["arrivals"]) if "arrivals" in item else None


def objectives_of(document: Mapping[str, Any]) -> tuple[Objective, ...] | None:
    """Return the objectives of a JSON answer, where the request named them."""
    if "objectives" not in document:
        return None
    return tuple(Objective(each["name"], each.get("unit")) for each in document["objectives"])


def parse_uncovered(document: Mapping[str, Any]) -> Uncovered | None:
    """Return what is uncovered of the map in a JSON answer; None where it does not say so."""
    if "uncovered" not in document:
        return None
    found = document["uncovered"]
    return Uncovered(
        cells=found["cells"],
        square_metres=found["square_metres"],
        regions=tuple(
            UncoveredRegion(
                cells=region["cells"],
                cell=_pair(region["cell"]),
                box=(_pair(region["box"][0]), _pair(region["box"][1])),
            )
            for region in found["regions"]
        ),
    )


def _pair(cell: Sequence[int]) -> tuple[int, int]:
    row, column = cell
    return row, column


def parse_path(item: Mapping[str, Any]) -> Path | None:
    """Return the path of a tour or route in a JSON answer, where the request asked for paths."""
    if "path" not in item:
        return None
    path = item["path"]
    points = read_only_floats(path["points"]) if "points" in path else None
    return Path(read_only_integers(path["cells"]), path["metres"], points)


def read_only_integers(values: Any) -> NDArray[np.int64]:
    """Return integers as an array that cannot be changed."""
    return _read_only(np.array(values, dtype=np.int64))


def read_only_floats(values: Any) -> Array:
    """Return numbers as an array that cannot be changed."""
    return _read_only(np.array(values, dtype=np.float64))


def _read_only(array: AnyArray) -> AnyArray:
    array.setflags(write=False)
    return array
