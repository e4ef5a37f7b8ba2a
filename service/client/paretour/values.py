"""What is asked of the service and what it answers, as typed values with arrays."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypedDict, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
A = TypeVar("A", bound=NDArray[Any])
FINAL = ("done", "cancelled", "failed")
Status = Literal["queued", "running", "done", "cancelled", "failed"]


class PlanRequest(TypedDict, total=False):
    """What any request may ask of a front. The service's documentation says what each means."""

    preferences: int | ArrayLike
    time_limit: float
    size: int
    start: int
    reference_point: ArrayLike
    initial_tours: ArrayLike
    bound: bool
    actor: str
    seed: int


class FrontRequest(PlanRequest, total=False):
    """The members of a request to POST /front: coordinates or matrices, and how to plan."""

    coordinates: ArrayLike
    matrices: ArrayLike
    augment: int


class CoverageRequest(PlanRequest, total=False):
    """The members of a request to POST /coverage: a map, places, a second objective."""

    grid: ArrayLike
    cell_size: float
    robot_radius: float
    places: ArrayLike
    spacing: float
    second_matrix: ArrayLike
    cost_layer: ArrayLike
    second_coordinates: ArrayLike
    paths: bool


@dataclass(frozen=True, kw_only=True)
class Progress:
    """How far a job has come: hypervolume and number of points, so many seconds into its search."""

    seconds: float
    hypervolume: float
    points: int


@dataclass(frozen=True, eq=False)
class Path:
    """The cells of a map, rows and columns, shape (m, 2), that a tour leads over and back."""

    cells: NDArray[np.int64]
    metres: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Tour:
    """A tour of the front with this id: cities, shape (n,), both lengths, and its angle.

    Over a map it visits places, and has a path where paths were asked for.
    """

    front: str
    angle: float
    lengths: Array
    tour: NDArray[np.int64]
    path: Path | None


@dataclass(frozen=True, kw_only=True, eq=False)
class Front:
    """Tours, shape (m, n), with lengths, shape (m, 2), and angles in degrees, shape (m,).

    They ascend by their first length. Of `points` nondominated tours found these are the ones
    returned. Over a map, cities are `places`, rows and columns, shape (n, 2), and each tour has a
    path where paths were asked for. `document` is the answer as it came, with every member.
    """

    id: str
    status: Status
    tours: NDArray[np.int64]
    lengths: Array
    angles: Array
    points: int
    hypervolume: float
    hypervolume_bound: float | None
    reference_point: Array
    scale: Array
    actor: str
    terminated: Literal["converged", "time_limit", "cancelled"] | None
    places: NDArray[np.int64] | None
    paths: tuple[Path, ...] | None
    document: Mapping[str, Any]

    def nearest(self, angle: float) -> Tour:
        """The tour whose direction is nearest to an angle in degrees.

        Raises:
            ValueError: the front is still empty.
        """
        index = int(np.abs(self.angles - angle).argmin())
        return Tour(
            front=self.id,
            angle=float(self.angles[index]),
            lengths=self.lengths[index],
            tour=self.tours[index],
            path=None if self.paths is None else self.paths[index],
        )


@dataclass(frozen=True, kw_only=True)
class Actor:
    """A network to choose: SHA-256 of its file, what it reads, and what was measured of it."""

    name: str
    digest: str
    inputs: str
    commit: str
    sizes: Any
    angles: Any
    config: Any
    figures: Any


def front_of(document: Mapping[str, Any]) -> Front:
    """The front in an answer."""
    items: Sequence[Mapping[str, Any]] = document["front"]
    tours = _whole([item["tour"] for item in items])
    paths = tuple(path for item in items if (path := _path_of(item)) is not None)
    return Front(
        id=document["id"],
        status=document["status"],
        tours=tours.reshape(len(items), document["cities"]),
        lengths=_floats([item["lengths"] for item in items]).reshape(-1, 2),
        angles=_floats([item["angle"] for item in items]),
        points=document["points"],
        hypervolume=document["hypervolume"],
        hypervolume_bound=document["hypervolume_bound"],
        reference_point=_floats(document["reference_point"]),
        scale=_floats(document["scale"]),
        actor=document["actor"]["name"],
        terminated=document["terminated"],
        places=_whole(document["places"]) if "places" in document else None,
        paths=paths or None,
        document=document,
    )


def tour_of(document: Mapping[str, Any]) -> Tour:
    """The tour in an answer."""
    return Tour(
        front=document["front"],
        angle=document["angle"],
        lengths=_floats(document["lengths"]),
        tour=_whole(document["tour"]),
        path=_path_of(document),
    )


def _path_of(item: Mapping[str, Any]) -> Path | None:
    if "path" not in item:
        return None
    return Path(_whole(item["path"]["cells"]), item["path"]["metres"])


def _whole(values: Any) -> NDArray[np.int64]:
    return _fixed(np.array(values, dtype=np.int64))


def _floats(values: Any) -> Array:
    return _fixed(np.array(values, dtype=np.float64))


def _fixed(array: A) -> A:
    array.setflags(write=False)
    return array
