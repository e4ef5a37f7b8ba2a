"""What is left of a way when something has changed: to replan, from nothing, and for OR-Tools."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from models.data.generators import clustered, uniform
from service.instance import Instance
from service.replanning.earlier_tours import EarlierTours
from service.replanning.insertion import completed

Array = NDArray[np.float64]
Tours = NDArray[np.int64]

SHAPES: Mapping[str, Callable[[int, Generator], Array]] = {
    "uniform": uniform,
    "clustered": clustered,
}
ROADS, ROADS_COSTS = "Helsinki roads", "Helsinki roads, costs"
ROAD_STOPS = 50  # of the sixty of the example; those that are added are among the others
_SLOWER = 3.0  # times as much as before costs a step that has changed
_DONE = 10  # the tenth part of the driven tour's stops is done


@dataclass(frozen=True, eq=False)
class Stops:
    """The stops that a benchmark draws: those of a front, and others that may be added.

    Exactly one of coordinates, shape (m, 4), and matrices, shape (2, m, m), is given. They are of
    all stops; the first n are the front's.
    """

    n: int
    coordinates: Array | None = None
    matrices: Array | None = None

    def request(self, stops: Sequence[int]) -> dict[str, Any]:
        """Return the members of a request that say the costs between some stops."""
        if self.coordinates is not None:
            return {"coordinates": self.coordinates[list(stops)].tolist()}
        assert self.matrices is not None
        return {"matrices": self.matrices[:, stops][:, :, stops].tolist()}

    def added(self, stop: int, added: Sequence[int]) -> dict[str, Any]:
        """Return a stop as a request to replan has it that adds these."""
        if self.coordinates is not None:
            row = self.coordinates[stop].tolist()
            return {"id": f"new {stop}", "coordinates": [row[:2], row[2:]]}
        assert self.matrices is not None
        order = [*range(self.n), *added]
        costs = [
            {"to": matrix[stop, order].tolist(), "from": matrix[order, stop].tolist()}
            for matrix in self.matrices
        ]
        return {"id": f"new {stop}", "costs": costs}


@dataclass(frozen=True, eq=False)
class Rest:
    """The rest of a way: as a request to replan, as one from nothing, and as hints for OR-Tools.

    Args:
        changes: The body of a request to replan.
        request: The body of a request for a front of the same rest.
        instance: The same rest, with the cities in the order of the request.
        hints: The tours of the front, cut and completed, shape (k, cities).
        balance: Of the tour being driven, in the front.
    """

    changes: dict[str, Any]
    request: dict[str, Any]
    instance: Instance
    hints: Tours
    balance: float


def draw_stops(shape: str, n: int, changed: int, generator: Generator) -> Stops:
    """Return stops of a shape, and as many more as are to be added."""
    if shape in (ROADS, ROADS_COSTS):
        return _road_stops(n, changed, generator)
    draw = SHAPES[shape]
    cities = np.concatenate((draw(n, generator), draw(n, generator)), axis=1)
    drawn = generator.integers(0, n, (changed, 2))
    new = np.concatenate((cities[drawn[:, 0], :2], cities[drawn[:, 1], 2:]), axis=1)
    new += generator.normal(0, 0.01, new.shape)
    return Stops(n, coordinates=np.concatenate((cities, new)))


def _road_stops(n: int, changed: int, generator: Generator) -> Stops:
    """Return stops of the example of Helsinki, with the matrices that are committed with it."""
    text = (
        files("service.examples").joinpath("helsinki-deliveries.json").read_text(encoding="utf-8")
    )
    matrices = np.array([each["matrix"] for each in json.loads(text)["objectives"]], np.float64)
    chosen = generator.permutation(matrices.shape[1])[: n + changed]
    return Stops(n, matrices=matrices[:, chosen][:, :, chosen])


def with_stops_changed(
    stops: Stops, front: dict[str, Any], removals: int, additions: int, generator: Generator
) -> Rest:
    """Return the rest after a number of stops were removed and added."""
    driven, done = _driven(front)
    removed = generator.choice(driven[done + 1 :], removals, replace=False).tolist()
    added = list(range(stops.n, stops.n + additions))
    changes = {
        "done": driven[: done + 1],
        "tour": driven,
        "remove": removed,
        "add": [stops.added(stop, added) for stop in added],
    }
    left = [stop for stop in driven[done:] if stop not in removed]
    return _rest(stops, front, changes, [*left, *added, driven[0]])


def with_costs_changed(
    stops: Stops, front: dict[str, Any], changed: int, generator: Generator
) -> Rest:
    """Return the rest after some steps of the driven tour became dearer, in both directions."""
    assert stops.matrices is not None
    driven, done = _driven(front)
    at = generator.choice(np.arange(done, len(driven) - 1), changed, replace=False)
    matrices = stops.matrices.copy()
    entries = []
    for one, other in ((driven[k], driven[k + 1]) for k in at):
        for objective, i, j in (
            (m, *pair) for m in (0, 1) for pair in ((one, other), (other, one))
        ):
            matrices[objective, i, j] *= _SLOWER
            cost = float(matrices[objective, i, j])
            entries.append({"objective": objective, "from": i, "to": j, "cost": cost})
    changes = {"done": driven[: done + 1], "tour": driven, "costs": entries}
    now = Stops(stops.n, matrices=matrices)
    return _rest(now, front, changes, [*driven[done:], driven[0]])


def _driven(front: dict[str, Any]) -> tuple[list[int], int]:
    """Return the tour nearest to balance 0.5, and how many steps of it are done."""
    driven = _driven_item(front)["tour"]
    return driven, len(driven) // _DONE


def _driven_item(front: dict[str, Any]) -> dict[str, Any]:
    tour: dict[str, Any] = min(front["front"], key=lambda tour: abs(tour["balance"] - 0.5))
    return tour


def _rest(stops: Stops, front: dict[str, Any], changes: dict[str, Any], order: list[int]) -> Rest:
    """Return the rest through stops in this order, from the first to the last."""
    ends: dict[str, Any] = {"closed": False, "start": 0, "end": len(order) - 1}
    members = stops.request(order)
    instance = Instance(**{name: np.array(rows) for name, rows in members.items()}, **ends)
    place = {stop: index for index, stop in enumerate(order)}
    inner = set(order[1:-1])
    left = [[stop for stop in each["tour"] if stop in inner] for each in front["front"]]
    tours = [[0, *(place[stop] for stop in each), len(order) - 1] for each in left]
    hints = completed(instance, EarlierTours(np.array(tours)))
    balance = _driven_item(front)["balance"]
    return Rest(changes, {**members, **ends}, instance, hints, balance)
