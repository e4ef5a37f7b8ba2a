"""Judge plans by the words of the guide: which rules they break, and what their measures are."""

from collections import Counter
from collections.abc import Iterator
from itertools import accumulate, pairwise, permutations
from math import inf, isclose
from typing import Any, NamedTuple

from tests.fuzz.fleets_judged.day import is_over_the_day, timelines_of_day, with_days
from tests.fuzz.fleets_judged.profiles import driven_by
from tests.fuzz.fleets_judged.timeline import (
    Bounds,
    Json,
    Timeline,
    best_timelines,
    is_later,
    span_of,
    trips_of,
)
from tests.fuzz.fleets_judged.waits import bounds_of, has_waits

CLOSE = 1e-7


class Judged(NamedTuple):
    """A route, and what it costs. Its type of vehicles has one shift at most."""

    vehicle: Json
    stops: tuple[int, ...]
    best: list[Timeline]  # equally good
    lengths: tuple[float, ...]
    compared: float  # the length by which routes are compared


class Judge:
    """Knows a request, and judges routes and plans of it.

    Args:
        request: The request. Its references to stops are numbers, its ids these as text, and its
            objectives have matrices, maybe one for each profile, or costs over the day.
    """

    def __init__(self, request: Json) -> None:
        request = with_days(request)
        self.request = request
        self.stops = request["stops"]
        self.objectives = request["objectives"]
        by_name = {each["name"]: each for each in self.objectives}
        clock = request.get("clock")
        self.clock = by_name.get(clock) if isinstance(clock, str) else clock
        self.vehicles = [
            {**vehicle, **({"shift": shift} if shift else {}), "number": number}
            for vehicle in request["vehicles"]
            for number, shift in enumerate(vehicle.get("shifts") or [vehicle.get("shift")])
        ]
        self.depots = {
            place
            for each in request["vehicles"]
            for place in (each.get("start"), each.get("end"), *each.get("reload", ()))
        } - {None}
        self.clients = [i for i in range(len(self.stops)) if i not in self.depots]
        self.shipments = [(each["pickup"], each["delivery"]) for each in request["shipments"]]
        self.pickup_of = {delivery: pickup for pickup, delivery in self.shipments}
        profiles = dict.fromkeys(each.get("profile") for each in request["vehicles"])
        self.own = {p: Judge(driven_by(p, request)) for p in profiles if p is not None}
        for each in self.own.values():
            each.siblings = [*self.own.values()]
        self.siblings = [self]

    def prize(self, stop: int) -> float | None:
        """Return the prize of a stop; None if it must be visited."""
        prize: float | None = self.stops[self.pickup_of.get(stop, stop)].get("prize")
        return prize

    def route(
        self, vehicle: Json, stops: tuple[int, ...], bounds: Bounds | None = None
    ) -> Judged | str:
        """Return the lengths of a route, or a rule that it breaks."""
        profile = vehicle.get("profile")
        return self.own.get(profile, self)._judged(vehicle, stops, bounds or {})

    def beside(self, routes: list[tuple[Json, tuple[int, ...]]]) -> list[Judged] | str:
        """Return the routes of a plan, whose visits may wait for others, or a rule they break."""
        bounds: Bounds | None = {}
        if has_waits(self.request):
            own = [self.own.get(vehicle.get("profile"), self) for vehicle, _ in routes]
            bounds = bounds_of(self.request, [each.clock["matrix"] for each in own], routes)
        if bounds is None:
            return "waits"
        found = []
        for vehicle, stops in routes:
            judged = self.route(vehicle, stops, bounds)
            if isinstance(judged, str):
                return f"{judged} on {stops}"
            found.append(judged)
        return found

    def _judged(self, vehicle: Json, stops: tuple[int, ...], bounds: Bounds) -> Judged | str:
        ends = ([] if each is None else [each] for each in (vehicle.get("start"), None))
        path = [*next(ends), *stops, *([] if vehicle.get("end") is None else [vehicle["end"]])]
        matrices = [each["matrix"] for each in self.objectives if "matrix" in each]
        if isinstance(self.request.get("clock"), dict):
            matrices.append(self.clock["matrix"])
        if any(matrix[a][b] is None for matrix in matrices for a, b in pairwise(path)):
            return "way"
        if broken := next(self._broken(vehicle, list(stops)), None):
            return broken
        best = self._timelines(vehicle, list(stops), bounds)
        if self.clock is not None and not best:
            return "times"
        times = best[0] if best else None
        compared = self._compared(times, path)
        reach = 0.0 if times is None else 1e-9 * times.end
        if wrong := _wrong_length(vehicle, compared, reach) or self._too_far(vehicle, path, times):
            return wrong
        if times is not None:  # visits begin as early as the departure allows
            times = min(best, key=lambda each: sum(each.begins))
        lengths = [self._length(each, vehicle, stops, path, times) for each in self.objectives]
        duration = 0.0 if times is None else times.end - times.departure
        lengths[0] *= vehicle.get("per_distance", 1.0)
        lengths[0] += vehicle.get("per_time", 0.0) * duration
        return Judged(vehicle, stops, best, tuple(lengths), compared)

    def _timelines(self, vehicle: Json, stops: list[int], bounds: Bounds) -> list[Timeline]:
        if self.clock is None:
            return []
        if is_over_the_day(self.request):
            return timelines_of_day(self.request, self.clock, vehicle, stops)
        return best_timelines(self.request, self.clock["matrix"], vehicle, stops, bounds)

    def _broken(self, vehicle: Json, stops: list[int]) -> Iterator[str]:
        """Yield the rules about skills, numbers of stops, trips and loads that a route breaks."""
        trips = trips_of(vehicle, stops)
        visited = [stop for trip in trips for stop in trip]
        if any(not self._may_visit(vehicle, self.stops[stop]) for stop in visited):
            yield "skills or vehicle"
        if len(visited) > vehicle.get("max_stops", inf):
            yield "max_stops"
        if len(trips) > vehicle.get("max_trips", inf) or not all(trips[1:]):
            yield "max_trips"
        if any(
            max(self._loads(vehicle, trips, number, dimension)) > capacity
            for dimension, capacity in enumerate(vehicle.get("capacity", ()))
            for number in range(len(trips))
        ):
            yield "capacity"
        if len(visited) < vehicle.get("min_stops", 0):
            yield "min_stops"
        yield from self._groups_broken(visited)
        for pickup, delivery in self.shipments:
            # Both or neither are visited, in this order.
            if [stop for stop in visited if stop in (pickup, delivery)] not in (
                [],
                [pickup, delivery],
            ):
                yield "shipment"

    def _groups_broken(self, visited: list[int]) -> Iterator[str]:
        """Yield the rules about groups of stops that a route breaks."""
        inside = set(visited)
        for group in self.request.get("together", ()):
            if inside & set(group) and not set(group) <= inside:
                yield "together"
        for each in self.request.get("apart", ()):
            stops, others = set(each["stops"]) & inside, set(each.get("others", ())) & inside
            if (stops and others) or (not each.get("others") and len(stops) > 1):
                yield "apart"
        for each in self.request.get("before", ()):
            last = max((visited.index(stop) for stop in each["first"] if stop in inside), default=0)
            if any(visited.index(stop) < last for stop in each["then"] if stop in inside):
                yield "before"

    def _may_visit(self, vehicle: Json, visit: Json) -> bool:
        able = set(visit.get("skills", ())) <= set(vehicle.get("skills", ()))
        return able and visit.get("vehicle") in (None, vehicle["id"])

    def _loads(
        self, vehicle: Json, trips: list[list[int]], number: int, dimension: int
    ) -> list[int]:
        """Return the load on a trip: at its start, and after each visit."""
        deliveries = dict(self.shipments)
        loads = []
        for stop in trips[number]:
            demand = self.stops[self.pickup_of.get(stop, stop)].get("demand") or [0] * 9
            taken = self.stops[stop].get("pickup") or [0] * 9
            brought = -demand[dimension] if stop not in deliveries else demand[dimension]
            loads.append(brought + taken[dimension])
        shipped = {*deliveries, *self.pickup_of}
        demands = [self.stops[s].get("demand") for s in trips[number] if s not in shipped]
        first = sum(demand[dimension] for demand in demands if demand)
        if number == 0 and vehicle.get("initial_load"):
            first += vehicle["initial_load"][dimension]
        return list(accumulate(loads, initial=first))

    def _compared(self, times: Timeline | None, path: list[int]) -> float:
        """Return the length by which routes are compared."""
        if times is not None:
            return times.end - times.departure
        longest = [each for each in self.objectives if each.get("over") == "max"]
        matrix = (longest or self.objectives)[0]["matrix"]
        return float(sum(matrix[a][b] for a, b in pairwise(path)))

    def _is_clock(self, objective: Json) -> bool:
        if self.clock is None or isinstance(self.request["clock"], dict):
            return False
        if sum("matrix" in each for each in self.objectives) > 2:
            return all(objective.get(name) == self.clock.get(name) for name in ("matrix", "day"))
        return objective is self.clock

    def _length(
        self,
        objective: Json,
        vehicle: Json,
        stops: tuple[int, ...],
        path: list[int],
        times: Timeline | None,
    ) -> float:
        if "matrix" in objective:
            if times is not None and self._is_clock(objective):
                return times.end - times.departure
            return float(sum(self._legs(objective, vehicle, path, times)))
        match objective["measure"]:
            case "vehicles":
                return 1.0
            case "overtime" | "lateness" | "earliness" | "weighted_arrival" as measure if times:
                return self._of_times(measure, vehicle, path, times)
            case "load_distance":
                return self._load_distance(vehicle, stops, path, times)
            case "imbalance":
                return self._compared(times, path)
            case "overlap":
                return self._overlap(stops)
        return 0.0

    def _overlap(self, stops: tuple[int, ...]) -> float:
        """Return the share of neighbours, of all stops, that do not ride with the stops of a route.

        There are so few stops that each has all others as neighbours.
        """
        apart = {(a, b): self._apart(a, b) for a, b in permutations(self.clients, 2)}
        ways = [way for way in apart.values() if way < inf]
        mean = sum(ways) / len(ways) if any(ways) else 1.0
        near = {pair: 1 / (1 + (way / mean) ** 2) for pair, way in apart.items()}
        missing = (near[a, b] for a, b in near if a in stops and b not in stops)
        return sum(missing) / (sum(near.values()) or 1.0)

    def _apart(self, a: int, b: int) -> float:
        """Return how far two stops are apart by the first costs; infinite without a way.

        Where vehicles drive by profiles, it is the least way of any.
        """
        return min(each.way_between(a, b) for each in self.siblings)

    def way_between(self, a: int, b: int) -> float:
        """Return how far two stops are apart to all vehicles."""
        matrices = [each["matrix"] for each in self.objectives if "matrix" in each]
        if isinstance(self.request.get("clock"), dict):
            matrices.append(self.clock["matrix"])
        ways = [
            matrices[0][i][j]
            for i, j in ((a, b), (b, a))
            if all(each[i][j] is not None for each in matrices)
        ]
        return float(min(ways, default=inf))

    def _of_times(self, measure: str, vehicle: Json, path: list[int], times: Timeline) -> float:
        begins = zip(path, times.begins, strict=True)
        visits = [(self.stops[stop], begin) for stop, begin in begins if stop not in self.depots]
        if measure == "lateness":
            return times.lateness
        if measure == "overtime":
            ends = span_of({**vehicle, "max_overtime": 0.0})[1]
            return times.end - ends if is_later(times.end, ends) else 0.0
        if measure == "weighted_arrival":
            first = min(span_of(each)[0] for each in self.vehicles)
            return float(sum(stop.get("urgency", 1.0) * (begin - first) for stop, begin in visits))
        wanted = [(stop["due"][0], begin) for stop, begin in visits if _is_pair(stop.get("due"))]
        return float(sum(due - begin for due, begin in wanted if is_later(due, begin)))

    def _too_far(self, vehicle: Json, path: list[int], times: Timeline | None) -> str:
        """Return whether the legs of a route are over their limits, as the rule; else ""."""
        others = [each for each in self.objectives if "matrix" in each and not self._is_clock(each)]
        if self.clock is None:
            others = others[:1]
        else:
            driven = sum(self._legs(self.clock, vehicle, path, times))
            if is_later(driven, vehicle.get("max_driving", inf)):
                return "max_driving"
        most = vehicle.get("max_distance", inf)
        driven_ways = (sum(self._legs(each, vehicle, path, times)) for each in others)
        return "max_distance" if any(is_later(way, most) for way in driven_ways) else ""

    def _legs(
        self, objective: Json, vehicle: Json, path: list[int], times: Timeline | None
    ) -> list[float]:
        """Return what each leg of a path costs a vehicle, when it drives there."""
        timed = objective is self.clock or self._is_clock(objective)
        speed = vehicle.get("speed_factor", 1.0) if timed else 1.0
        day, legs = objective.get("day"), [*pairwise(path)]
        if day is None:
            return [objective["matrix"][a][b] / speed for a, b in legs]
        assert times is not None
        if timed:
            return [b - a for a, b in zip(times.leaves, times.arrivals[1:], strict=False)]
        pairs = zip(legs, times.leaves, strict=False)
        return [day.at(a, b, time) for (a, b), time in pairs]

    def _load_distance(
        self, vehicle: Json, stops: tuple[int, ...], path: list[int], times: Timeline | None
    ) -> float:
        trips = trips_of(vehicle, list(stops))
        loads = [x for i in range(len(trips)) for x in self._loads(vehicle, trips, i, 0)]
        if vehicle.get("start") is None:
            del loads[0]
        if vehicle.get("end") is None:
            del loads[-1]
        legs = self._legs(self.objectives[0], vehicle, path, times)
        return sum(leg * x for leg, x in zip(legs, loads, strict=True))

    def lengths(self, routes: list[Judged]) -> tuple[float, ...]:
        """Return the lengths of a plan of these routes."""
        visited = {stop for each in routes for stop in each.stops}
        lost = sum(self.stops[s].get("prize", 0.0) for s in self.clients if s not in visited)
        found = []
        for index, objective in enumerate(self.objectives):
            column = [each.lengths[index] for each in routes] or [0.0]
            over = objective.get("measure", objective.get("over", "sum"))
            joined = {"max": max(column), "imbalance": max(column) - min(column)}
            found.append(lost if over == "unassigned" else joined.get(over, sum(column)))
        found[0] += sum(each.vehicle.get("fixed", 0.0) for each in routes)
        if all(each.get("measure") != "unassigned" for each in self.objectives):
            found[0] += lost
        return tuple(found)

    def faults(self, plan: Json) -> Iterator[str]:
        """Yield what is wrong with a plan of an answer."""
        pairs = [self._driven(route) for route in plan["routes"]]
        used = Counter((vehicle["id"], vehicle["number"]) for vehicle, _ in pairs)
        visits = Counter(s for _, stops in pairs for s in stops if s not in self.depots)
        routes = self.beside(pairs)
        if isinstance(routes, str):
            yield f"breaks {routes}: {plan['routes']}"
            return
        for route, judged in zip(plan["routes"], routes, strict=True):
            yield from self._misreported(route, judged)
        for vehicle in self.vehicles:
            if used[vehicle["id"], vehicle["number"]] > vehicle.get("count", 1):
                yield "too many vehicles"
        for stop in self.clients:
            if visits[stop] != 1 and (visits[stop] or self.prize(stop) is None):
                yield f"stop {stop} is visited {visits[stop]} times"
        if not _close(plan["lengths"], self.lengths(routes), self._reach(routes)):
            yield f"lengths {plan['lengths']} are {self.lengths(routes)}"

    def _driven(self, route: Json) -> tuple[Json, tuple[int, ...]]:
        """Return the vehicle of a route of an answer, and the stops on its way."""
        name = route["vehicle"], route.get("shift", 0)
        vehicle = next(each for each in self.vehicles if (each["id"], each["number"]) == name)
        path = [int(stop) for stop in route["stops"]]
        begin = vehicle.get("start") is not None
        return vehicle, tuple(path[begin : len(path) - (vehicle.get("end") is not None)])

    def _reach(self, routes: list[Judged]) -> float:
        return max([each.best[0].end for each in routes if each.best], default=1.0)

    def _misreported(self, route: Json, judged: Judged) -> Iterator[str]:
        """Yield where the times that are told of a route are not the best."""
        if not judged.best:
            return
        best, departure = judged.best[0], route["arrivals"][0]
        if not _close([departure], [best.departure], best.end):
            yield f"leaves at {departure}, and could at {best.departure}: {route}"
        elif not any(
            _close(route["arrivals"], each.arrivals, each.end)
            and _close(route.get("breaks", ()), each.breaks, each.end)
            for each in judged.best
        ):
            yield f"arrivals {route['arrivals']} are {best.arrivals}"


def _wrong_length(vehicle: Json, length: float, reach: float) -> str:
    """Return whether a route is too long or too short, as the rule that it breaks; else ""."""
    if is_later(length - reach, vehicle.get("longest", inf)):
        return "longest"
    return "shortest" if is_later(vehicle.get("shortest", 0.0) - reach, length) else ""


def _is_pair(due: Any) -> bool:
    return isinstance(due, list)


def _close(numbers: Any, others: Any, reach: float) -> bool:
    return len(numbers) == len(others) and all(
        isclose(a, b, rel_tol=CLOSE, abs_tol=CLOSE * max(1e-6, reach))
        for a, b in zip(numbers, others, strict=True)
    )
