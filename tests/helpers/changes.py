"""Random fronts with random changes on the way, and what is left of them by brute force."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.kinds.parsing import parse_task
from service.requests.limits import Limits
from service.requests.replan.way import FoundTours, StoredFront
from service.requests.task import TaskSource
from service.requests.task_codec import encode_task
from service.roads.great_circle import great_circle_matrix
from tests.helpers.actors import info_of

Array = NDArray[np.float64]
MOST = 9  # stops in all, for which the search compares all tours
KINDS = ("coordinates", "matrices", "mixed", "measured")
_ROOM = Limits(
    body_bytes=2**27,
    cities=9999,
    cells=10**6,
    preferences=999,
    size=9999,
    seconds=99,
    path_cells=2**30,
    roads=True,
)
_ACTORS = {inputs: info_of(inputs, inputs) for inputs in ("coordinates", "matrices")}


@dataclass(frozen=True, eq=False)
class Found:
    """Tours of a front, as what is stored of it gives them."""

    orders: NDArray[np.int64]
    lengths: Array
    places: Sequence[Sequence[int]] | None = None

    def split(self) -> list[bytes]:
        """Return the JSON of each tour; none is needed to replan tours."""
        return []


@dataclass(frozen=True, eq=False)
class FrontOf(StoredFront):
    """A stored front, and the request that it was planned from."""

    source: TaskSource


def front_of(source: TaskSource, found: FoundTours) -> FrontOf:
    """Return the front of a request as a store keeps it."""
    return FrontOf("front", encode_task(parse_task(source, _ROOM, _ACTORS)), found, source)


@dataclass(frozen=True, eq=False)
class Change:
    """A stored front, a request to replan it, and the problem that is left.

    Args:
        front: The stored front.
        request: The request.
        costs: Between all stops, those of the front and new ones, shape (2, size, size).
        ids: Of all stops.
        start: Where the way goes on, None where anywhere.
        end: Where it ends, None where anywhere; the start of a way that leads back to it.
        between: The stops to visit on the way.
        driven: What is left of the tour being driven, in indexes of all stops.
    """

    front: FrontOf
    request: dict[str, Any]
    costs: Array
    ids: list[str]
    start: int | None
    end: int | None
    between: list[int]
    driven: list[int]

    def ways(self) -> Iterator[tuple[int, ...]]:
        """All ways that are left."""
        begin = () if self.start is None else (self.start,)
        last = () if self.end in (None, self.start) else (self.end,)
        for way in permutations(self.between):
            yield (*begin, *way, *last)

    @property
    def back(self) -> bool:
        """Whether the way leads back to where it goes on."""
        return self.end is not None and self.start == self.end

    def legs(self, way: tuple[int, ...] | list[int]) -> list[tuple[int, int]]:
        """The steps of a way."""
        closed = [*way, way[0]] if self.back else list(way)
        return list(pairwise(closed))

    def point(self, way: tuple[int, ...]) -> tuple[float, float]:
        """Both lengths of a way."""
        first, second = (sum(costs[i, j] for i, j in self.legs(way)) for costs in self.costs)
        return float(first), float(second)

    def kept(self, way: tuple[int, ...]) -> float:
        """The share of the driven tour's legs that a way keeps."""
        legs = [leg for leg in self.legs(self.driven) if leg[0] != leg[1]]
        if not legs:
            return 1.0
        steps = set(self.legs(way))
        if self._symmetric(way):
            steps |= {(j, i) for i, j in steps}
        return sum(leg in steps for leg in legs) / len(legs)

    def _symmetric(self, way: tuple[int, ...]) -> bool:
        rest = self.costs[:, list(way)][:, :, list(way)]
        return bool(np.array_equal(rest, rest.transpose(0, 2, 1)))


@dataclass(frozen=True, eq=False)
class _Ends:
    """How a front's tours lead: its stops, and the first and last of each, None where any."""

    n: int
    closed: bool
    first: int | None
    last: int | None

    def tour(self, rng: np.random.Generator) -> list[int]:
        fixed = (self.first, self.last)
        inner = rng.permutation([i for i in range(self.n) if i not in fixed]).tolist()
        return [*_one(self.first), *inner, *_one(self.last)]


def _one(stop: int | None) -> list[int]:
    return [] if stop is None else [stop]


def random_change(seed: int, least: int = 4, most: int = 8) -> Change:
    """Return a random front with random changes."""
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    n = int(rng.integers(least, most + 1))
    closed = bool(rng.random() < 0.5)
    first = 0 if closed else (None, 0)[rng.integers(2)]
    way = _Ends(n, closed, first, None if closed or rng.random() < 0.5 else n - 1)
    tours = [way.tour(rng) for _ in range(3)]
    driven = tours[rng.integers(3)]
    place = bool(rng.random() < 0.4)
    added = int(rng.integers(0, min(2, MOST - n - place) + 1))
    request, costs, planes = _costs(rng, kind, n, n + added + place)
    ids = [str(index) for index in range(n)] if kind in KINDS[:2] else [f"s{i}" for i in range(n)]
    ids += [f"new {i}" for i in range(added + place)]
    new = [_new_stop(kind, request, (costs, planes), n, index, ids) for index in range(n, len(ids))]
    done = driven[: rng.integers(0, n - 1)]
    body = {
        "done": [_name(rng, ids, i) for i in done],
        "tour": [ids[i] for i in driven],
        "add": new[:added],
    }
    start = _position(rng, body, way, driven, done, new[added:])
    removed = _removed(rng, way, driven[len(done) :], start)
    body["remove"] = [_name(rng, ids, i) for i in removed]
    body["costs"] = list(_entries(rng, costs, ids, n))
    gone = {*done, *removed, *([] if start == way.first else _one(way.first))}
    end = way.first if closed else way.last
    between = [i for i in range(n + added) if i not in gone and i not in (start, end)]
    left = [
        *_one(start),
        *(i for i in driven if i in between),
        *([] if end == start else _one(end)),
    ]
    stored = _stored(rng, kind, way, {**request, **_said(way)}, tours, costs, ids)
    return Change(stored, body, costs, ids, start, end, between, left)


def _said(way: _Ends) -> dict[str, Any]:
    if way.closed:
        return {"closed": True}
    return {"closed": False, "start": way.first, "end": way.last}


def _position(
    rng: np.random.Generator,
    body: dict[str, Any],
    way: _Ends,
    driven: list[int],
    done: list[int],
    places: list[dict[str, Any]],
) -> int | None:
    """Say in a request where the way goes on, if not at the last that is done; return where."""
    if places:
        body["position"] = places[0]
        return way.n + len(body["add"])
    start = driven[len(done)]
    if done and start != way.last and rng.random() < 0.3:
        body["position"] = start
        return start
    return done[-1] if done else way.first


def _removed(rng: np.random.Generator, way: _Ends, left: list[int], start: int | None) -> list[int]:
    """The stops that are not visited any more: one or none."""
    free = [i for i in left if i not in (way.first, way.last, start)]
    return free[: rng.integers(0, 2)] if len(free) > 1 else []


def _stored(  # noqa: PLR0913  what is stored of a front
    rng: np.random.Generator,
    kind: str,
    way: _Ends,
    request: dict[str, Any],
    tours: list[list[int]],
    costs: Array,
    ids: list[str],
) -> FrontOf:
    turns = rng.integers(0, way.n, len(tours)) if way.closed else [0] * len(tours)
    turned = [np.roll(tour, turn) for tour, turn in zip(tours, turns, strict=True)]
    lengths = [[float(each[tour, np.roll(tour, -1)].sum()) for each in costs] for tour in turned]
    source = TaskSource("front", json.dumps(_named(request, ids, kind, way.n)).encode())
    return front_of(source, Found(np.array(turned), np.array(lengths)))


def _name(rng: np.random.Generator, ids: list[str], index: int) -> int | str:
    """A stop by its index or by its id."""
    return index if rng.random() < 0.5 else ids[index]


def _costs(
    rng: np.random.Generator, kind: str, n: int, size: int
) -> tuple[dict[str, Any], Array, Array]:
    """The members of the front's request that say its costs, those between all stops, planes.

    The members have the locations of all stops; the request takes the first n.
    """
    locations = rng.uniform((24.9, 60.1), (25.1, 60.2), (size, 2))
    planes = rng.integers(0, 9, (size, 4)).astype(float)
    matrices = rng.integers(0, 9, (2, size, size)).astype(float)
    matrices[:, range(size), range(size)] = 0
    steps = planes[:, np.newaxis] - planes
    plane_costs = np.stack([np.hypot(steps[..., m], steps[..., m + 1]) for m in (0, 2)])
    great = great_circle_matrix(locations)
    stops = {"stops": locations.tolist()}
    if kind == "coordinates":
        return {"coordinates": planes[:n].tolist()}, plane_costs, planes
    if kind == "matrices":
        return {"matrices": matrices[:, :n, :n].tolist()}, matrices, planes
    if kind == "mixed":
        objectives = [{"from": "great_circle"}, {"matrix": matrices[1, :n, :n].tolist()}]
        return {**stops, "objectives": objectives}, np.stack((great, matrices[1])), planes
    timed = {"from": "great_circle", "speed": 18}  # 5 metres per second
    objectives = [{"coordinates": planes[:n, :2].tolist()}, timed]
    return {**stops, "objectives": objectives}, np.stack((plane_costs[0], great / 5)), planes


def _new_stop(
    kind: str,
    request: dict[str, Any],
    known: tuple[Array, Array],
    n: int,
    index: int,
    ids: list[str],
) -> dict[str, Any]:
    """A new stop as a request has it."""
    costs, planes = known
    rows = [
        {"to": each[index].tolist(), "from": [*each[:n, index].tolist(), *[0] * (len(ids) - n)]}
        for each in costs
    ]
    plane, other = planes[index, :2].tolist(), planes[index, 2:].tolist()
    item: dict[str, Any] = {"id": ids[index]}
    if kind == "coordinates":
        return {**item, "coordinates": [plane, other]}
    if kind == "matrices":
        return {**item, "costs": rows}
    item["location"] = request["stops"][index]
    if kind == "mixed":
        return {**item, "costs": [None, rows[1]]}
    return {**item, "coordinates": [plane, None]}


def _entries(
    rng: np.random.Generator, costs: Array, ids: list[str], n: int
) -> Iterator[dict[str, Any]]:
    """Single costs that change, which `costs` has from then on."""
    for _ in range(rng.integers(0, 4)):
        m, (i, j) = int(rng.integers(2)), rng.permutation(len(ids))[:2].tolist()
        costs[m, i, j] = float(rng.integers(0, 20))
        origin = i if i < n and rng.random() < 0.5 else ids[i]
        yield {"objective": m, "from": origin, "to": ids[j], "cost": float(costs[m, i, j])}


def _named(request: dict[str, Any], ids: list[str], kind: str, n: int) -> dict[str, Any]:
    if kind in KINDS[:2]:
        return request
    stops = [
        {"id": name, "location": location}
        for name, location in zip(ids[:n], request["stops"][:n], strict=True)
    ]
    named = [
        {"name": name, **objective}
        for name, objective in zip(("way", "risk"), request["objectives"], strict=True)
    ]
    return {**request, "stops": stops, "objectives": named}
