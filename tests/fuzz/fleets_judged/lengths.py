"""What a route costs under each objective and measure, by the words of the guide."""

from collections.abc import Sequence
from itertools import pairwise, permutations
from math import inf
from typing import Any, NamedTuple

from tests.fuzz.fleets_judged.promises import promises_of
from tests.fuzz.fleets_judged.punctual import Driven, Taken, percentile, taken, taken_on_days
from tests.fuzz.fleets_judged.route_rules import RouteRules
from tests.fuzz.fleets_judged.timeline import (
    Json,
    Timeline,
    is_later,
    service_of,
    span_of,
    trips_of,
)


class Way(NamedTuple):
    """A route as a vehicle drives it."""

    vehicle: Json
    stops: tuple[int, ...]  # its visits, and where it loads again
    times: Timeline | None

    @property
    def path(self) -> list[int]:
        """All stops, with the start and the end."""
        return path_of(self.vehicle, self.stops)


def path_of(vehicle: Json, stops: Sequence[int]) -> list[int]:
    """Return the stops of a route with its start and its end."""
    start, end = ([] if each is None else [each] for each in map(vehicle.get, ("start", "end")))
    return [*start, *stops, *end]


class Lengths:
    """Knows what the costs of a request are, and measures routes.

    Args:
        request: The request, as a judge has it: all its costs have a matrix.
        clock: The item of the costs that are time.
        depots: The stops at which vehicles start, end or load.
        begin: When the first shift begins.
    """

    def __init__(self, request: Json, clock: Any, depots: set[int], begin: float) -> None:
        self._request, self._clock, self._depots, self._begin = request, clock, depots, begin
        self._stops, self._objectives = request["stops"], request["objectives"]
        self._clients = [i for i in range(len(self._stops)) if i not in depots]
        self._rules, self._promises = RouteRules(request), promises_of(request)
        self.siblings = [self]  # of all profiles

    @property
    def matrices(self) -> list[Any]:
        """The costs of all objectives, and the times if they are none of these."""
        matrices = [each["matrix"] for each in self._objectives if "matrix" in each]
        if isinstance(self._request.get("clock"), dict):
            matrices.append(self._clock["matrix"])
        return matrices

    def of(self, way: Way) -> tuple[float, ...]:
        """Return the lengths of a route, before fixed costs and prizes."""
        lengths = [self.length(each, way) for each in self._objectives]
        lengths[0] *= way.vehicle.get("per_distance", 1.0)
        lengths[0] += way.vehicle.get("per_time", 0.0) * _duration(way.times)
        return tuple(lengths)

    def compared(self, way: Way) -> float:
        """Return the length by which routes are compared."""
        if way.times is not None:
            return _duration(way.times)
        longest = [each for each in self._objectives if each.get("over") == "max"]
        matrix = (longest or self._objectives)[0]["matrix"]
        return float(sum(matrix[a][b] for a, b in pairwise(way.path)))

    def length(self, objective: Json, way: Way) -> float:
        """Return the length of a route under an objective."""
        if "measure" in objective:
            return self._measured(objective["measure"], way)
        if "percentile" in objective:
            goes = self.taken(way)
            assert goes is not None
            return percentile([goes], objective["percentile"])
        if way.times is not None and self._is_clock(objective):
            return _duration(way.times)
        return float(sum(self.legs(objective, way)))

    def summed(self, name: str, way: Way) -> float:
        """Return what a route adds to a measure of plans."""
        match name:
            case "driving":
                return sum(self.legs(self._clock, way))
            case "waiting":
                assert way.times is not None
                return way.times.waiting
            case "service":
                return sum(service_of(self._stops[stop], way.vehicle) for stop in way.stops)
        return self._measured(name, way)

    def _measured(self, measure: str, way: Way) -> float:
        measured = {
            "vehicles": lambda _: 1.0,
            "load_distance": self._load_distance,
            "imbalance": self.compared,
            "overlap": self._overlap,
            "changes": self._changes,
            "on_time": self._late_visits,
            "overtime": self._overtime,
            "lateness": lambda way: way.times.lateness,
            "earliness": self._earliness,
            "weighted_arrival": self._weighted_arrival,
            "unassigned": lambda _: 0.0,
        }
        return float(measured[measure](way))

    def _is_clock(self, objective: Json) -> bool:
        if self._clock is None or isinstance(self._request["clock"], dict):
            return False
        of_days = any("percentile" in each or "days" in each for each in self._objectives)
        if of_days or sum("matrix" in each for each in self._objectives) > 2:
            return all(objective.get(name) == self._clock.get(name) for name in ("matrix", "day"))
        return objective is self._clock

    def legs(self, objective: Json, way: Way) -> list[float]:
        """Return what each leg of a route costs its vehicle, when it drives there."""
        timed = objective is self._clock or self._is_clock(objective)
        speed = way.vehicle.get("speed_factor", 1.0) if timed else 1.0
        day, legs, times = objective.get("day"), [*pairwise(way.path)], way.times
        if day is None:
            return [objective["matrix"][a][b] / speed for a, b in legs]
        assert times is not None
        if timed:
            return [b - a for a, b in zip(times.leaves, times.arrivals[1:], strict=False)]
        pairs = zip(legs, times.leaves, strict=False)
        return [day.at(a, b, time) for (a, b), time in pairs]

    def too_far(self, way: Way) -> str:
        """Return whether the legs of a route are over their limits, as the rule; else ""."""
        others = [
            each for each in self._objectives if "matrix" in each and not self._is_clock(each)
        ]
        if self._clock is None:
            others = others[:1]
        elif is_later(sum(self.legs(self._clock, way)), way.vehicle.get("max_driving", inf)):
            return "max_driving"
        most = way.vehicle.get("max_distance", inf)
        far = any(is_later(sum(self.legs(each, way)), most) for each in others)
        return "max_distance" if far else ""

    def taken(self, way: Way) -> Taken | None:
        """Return how a route goes from day to day; None if its times do not spread, or it rests."""
        if way.times is None or way.times.breaks or not {"spread", "days"} & self._clock.keys():
            return None
        path = way.path
        stops = [None if stop in self._depots else self._stops[stop] for stop in path]
        driven = Driven(stops, way.times, self.legs(self._clock, way))
        if "spread" in self._clock:
            return taken(driven, self._clock["spread"])
        speed = way.vehicle.get("speed_factor", 1.0)
        days = [each["matrix"] for each in self._clock["days"]]
        return taken_on_days(
            driven, [[day[a][b] / speed for a, b in pairwise(path)] for day in days]
        )

    def _late_visits(self, way: Way) -> float:
        goes = self.taken(way)
        assert goes is not None
        return sum(1.0 - share for share in goes.shares)

    def _changes(self, way: Way) -> int:
        """Return how many promised stops of a route ride with somebody else, or begin late."""
        path, promises = way.path, self._promises
        begins = [0.0] * len(path) if way.times is None else way.times.begins
        return sum(
            promises[stop].route != way.vehicle.get("route")
            or is_later(begin, promises[stop].until)
            for stop, begin in zip(path, begins, strict=True)
            if stop in promises
        )

    def _overlap(self, way: Way) -> float:
        """Return the share of neighbours, of all stops, that do not ride with the stops of a route.

        There are so few stops that each has all others as neighbours.
        """
        apart = {(a, b): self._apart(a, b) for a, b in permutations(self._clients, 2)}
        ways = [each for each in apart.values() if each < inf]
        mean = sum(ways) / len(ways) if any(ways) else 1.0
        near = {pair: 1 / (1 + (each / mean) ** 2) for pair, each in apart.items()}
        stops = way.stops
        missing = (near[a, b] for a, b in near if a in stops and b not in stops)
        return sum(missing) / (sum(near.values()) or 1.0)

    def _apart(self, a: int, b: int) -> float:
        """Return how far two stops are apart by the first costs; infinite without a way.

        Where vehicles drive by profiles, it is the least way of any.
        """
        return min(each.way_between(a, b) for each in self.siblings)

    def way_between(self, a: int, b: int) -> float:
        """Return how far two stops are apart to all vehicles."""
        ways = [
            self.matrices[0][i][j]
            for i, j in ((a, b), (b, a))
            if all(each[i][j] is not None for each in self.matrices)
        ]
        return float(min(ways, default=inf))

    def _visits(self, way: Way) -> list[tuple[Json, float]]:
        """Return the visits of a route, and when each begins."""
        assert way.times is not None
        begins = zip(way.path, way.times.begins, strict=True)
        return [(self._stops[stop], begin) for stop, begin in begins if stop not in self._depots]

    def _overtime(self, way: Way) -> float:
        ends = span_of({**way.vehicle, "max_overtime": 0.0})[1]
        assert way.times is not None
        return way.times.end - ends if is_later(way.times.end, ends) else 0.0

    def _weighted_arrival(self, way: Way) -> float:
        visits = self._visits(way)
        return float(sum(each.get("urgency", 1.0) * (at - self._begin) for each, at in visits))

    def _earliness(self, way: Way) -> float:
        pairs = [
            (each["due"][0], at) for each, at in self._visits(way) if _is_pair(each.get("due"))
        ]
        return float(sum(due - begin for due, begin in pairs if is_later(due, begin)))

    def _load_distance(self, way: Way) -> float:
        trips = trips_of(way.vehicle, list(way.stops))
        loads = [x for i in range(len(trips)) for x in self._rules.loads(way.vehicle, trips, i, 0)]
        if way.vehicle.get("start") is None:
            del loads[0]
        if way.vehicle.get("end") is None:
            del loads[-1]
        legs = self.legs(self._objectives[0], way)
        return sum(leg * x for leg, x in zip(legs, loads, strict=True))


def _duration(times: Timeline | None) -> float:
    return 0.0 if times is None else times.end - times.departure


def _is_pair(due: Any) -> bool:
    return isinstance(due, list)
