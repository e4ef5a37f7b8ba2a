"""Judge plans by the words of the guide: which rules they break, and what their measures are."""

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from math import inf, isclose
from typing import Any, NamedTuple

from tests.fuzz.fleets_judged.day import is_over_the_day, timelines_of_day, with_days
from tests.fuzz.fleets_judged.lengths import Lengths, Way, path_of
from tests.fuzz.fleets_judged.profiles import driven_by
from tests.fuzz.fleets_judged.promises import bounds_of_promises, promises_of, types_by_promise
from tests.fuzz.fleets_judged.punctual import Taken, percentile, with_means
from tests.fuzz.fleets_judged.route_rules import RouteRules
from tests.fuzz.fleets_judged.timeline import (
    Bounds,
    Json,
    Timeline,
    best_timelines,
    is_later,
    span_of,
)
from tests.fuzz.fleets_judged.waits import bounds_of, has_waits

CLOSE = 1e-7
# Where breaks are taken decides them, and that may be open.
_WITHOUT_BREAKS = ("on_time", "duration", "duration_p90", "earliness", "weighted_arrival")


class Open(Exception):
    """Over the day a route has several best times, or roundings decide what its legs cost."""


class Judged(NamedTuple):
    """A route, and what it costs. Its type of vehicles has one shift at most."""

    vehicle: Json
    stops: tuple[int, ...]
    best: list[Timeline]  # equally good
    lengths: tuple[float, ...]
    compared: float  # the length by which routes are compared
    taken: Taken | None = None  # how it goes from day to day, if times spread

    @property
    def driven(self) -> Way:
        """The route, whose visits begin as early as the departure allows."""
        times = min(self.best, key=lambda each: sum(each.begins)) if self.best else None
        return Way(self.vehicle, self.stops, times)


class Judge:
    """Knows a request, and judges routes and plans of it.

    Args:
        request: The request. Its references to stops are numbers, its ids these as text, and its
            objectives have matrices, maybe one for each profile, or costs over the day.
    """

    def __init__(self, request: Json) -> None:
        request = _with_matrices(request)
        self.request = request
        self.stops = request["stops"]
        self.objectives = request["objectives"]
        by_name = {each["name"]: each for each in self.objectives}
        clock = request.get("clock")
        self.clock = by_name.get(clock) if isinstance(clock, str) else clock
        shifts = [
            {**vehicle, **({"shift": shift} if shift else {}), "number": number}
            for vehicle in request["vehicles"]
            for number, shift in enumerate(vehicle.get("shifts") or [vehicle.get("shift")])
        ]
        self.vehicles = types_by_promise(request, shifts)
        self.promises = promises_of(request)
        self.depots = {
            place
            for each in request["vehicles"]
            for place in (each.get("start"), each.get("end"), *each.get("reload", ()))
        } - {None}
        self.clients = [i for i in range(len(self.stops)) if i not in self.depots]
        self.rules = RouteRules(request)
        profiles = dict.fromkeys(each.get("profile") for each in request["vehicles"])
        self.own = {p: Judge(driven_by(p, request)) for p in profiles if p is not None}
        begin = min(span_of(each)[0] for each in self.vehicles)
        self._measured = Lengths(request, self.clock, self.depots, begin)
        for each in self.own.values():
            each._measured.siblings = [one._measured for one in self.own.values()]

    def prize(self, stop: int) -> float | None:
        """Return the prize of a stop; None if it must be visited."""
        prize: float | None = self.stops[self.rules.pickup_of.get(stop, stop)].get("prize")
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
        legs = [*pairwise(path_of(vehicle, stops))]
        if any(matrix[a][b] is None for matrix in self._measured.matrices for a, b in legs):
            return "way"
        if broken := next(self.rules.broken(vehicle, list(stops)), None):
            return broken
        best = self._timelines(vehicle, list(stops), self._with_promises(bounds))
        if self.clock is not None and not best:
            return "times"
        way = Way(vehicle, stops, best[0] if best else None)
        compared = self._measured.compared(way)
        reach = 0.0 if way.times is None else 1e-9 * way.times.end
        if wrong := _wrong_length(vehicle, compared, reach) or self._measured.too_far(way):
            return wrong
        if best:  # visits begin as early as the departure allows
            way = way._replace(times=min(best, key=lambda each: sum(each.begins)))
        goes = None if self.clock is None else self._measured.taken(way)
        lengths = self._measured.of(way)
        if is_over_the_day(self.request):
            ways = (way._replace(times=each) for each in best)
            if not all(_close(self._measured.of(each), lengths, 1.0) for each in ways):
                raise Open
        return Judged(vehicle, stops, best, lengths, compared, goes)

    def _with_promises(self, bounds: Bounds) -> Bounds:
        """Return bounds of visits that are also those of promised ones."""
        found = bounds_of_promises(self.request)
        for stop, (since, hold) in bounds.items():
            found[stop] = since, min(hold, found.get(stop, (0.0, inf))[1])
        return found

    def _timelines(self, vehicle: Json, stops: list[int], bounds: Bounds) -> list[Timeline]:
        if self.clock is None:
            return []
        if is_over_the_day(self.request):
            return timelines_of_day(self.request, self.clock, vehicle, stops)
        return best_timelines(self.request, self.clock["matrix"], vehicle, stops, bounds)

    def lengths(self, routes: list[Judged]) -> tuple[float, ...]:
        """Return the lengths of a plan of these routes."""
        visited = {stop for each in routes for stop in each.stops}
        lost = self._lost(visited)
        found = []
        for index, objective in enumerate(self.objectives):
            column = [each.lengths[index] for each in routes] or [0.0]
            over = objective.get("measure", objective.get("over", "sum"))
            joined = {"max": max(column), "imbalance": max(column) - min(column)}
            found.append(lost if over == "unassigned" else joined.get(over, sum(column)))
            if over == "changes":
                found[-1] += len(self.promises.keys() - visited)
            if over == "sum" and "percentile" in objective:
                goes = [each.taken for each in routes if each.taken]
                found[-1] = percentile(goes, objective["percentile"])
        found[0] += sum(each.vehicle.get("fixed", 0.0) for each in routes)
        if all(each.get("measure") != "unassigned" for each in self.objectives):
            found[0] += lost
        return tuple(found)

    def faults(self, plan: Json) -> Iterator[str]:
        """Yield what is wrong with a plan of an answer.

        Raises:
            Open: A leg begins within a rounding of a change of costs, but not just then.
        """
        ends = [time for route in plan["routes"] for time in route.get("ends", ())]
        if any(0 < abs(a - b) <= CLOSE * max(1.0, b) for a in ends for b in self._changes()):
            raise Open
        pairs = [self.driven(route) for route in plan["routes"]]
        routes = self.beside(pairs)
        if isinstance(routes, str):
            yield f"breaks {routes}: {plan['routes']}"
            return
        for route, judged in zip(plan["routes"], routes, strict=True):
            yield from self._misreported(route, judged)
        yield from self._miscounted(pairs)
        reach = max([each.best[0].end for each in routes if each.best], default=1.0)
        if not _close(plan["lengths"], self.lengths(routes), reach):
            yield f"lengths {plan['lengths']} are {self.lengths(routes)}"
        for name, told in plan["measures"].items():
            known = self._measure(name, routes)
            if known is not None and not _close([told], [known], reach):
                yield f"{name} {told} is {known}: {plan['routes']}"

    def _changes(self) -> set[float]:
        """Return when costs change over the day."""
        own = [item for each in (*self.own.values(), self) for item in each.objectives]
        return {time for item in own if "day" in item for time in item["day"].changes}

    def _miscounted(self, routes: list[tuple[Json, tuple[int, ...]]]) -> Iterator[str]:
        """Yield what vehicles leave too often, and which stops are not visited once."""
        used = Counter(name_of(vehicle) for vehicle, _ in routes)
        visits = Counter(s for _, stops in routes for s in stops if s not in self.depots)
        for vehicle in self.vehicles:
            if used[name_of(vehicle)] > vehicle.get("count", 1):
                yield "too many vehicles"
        for stop in self.clients:
            if visits[stop] != 1 and (visits[stop] or self.prize(stop) is None):
                yield f"stop {stop} is visited {visits[stop]} times"

    def driven(self, route: Json) -> tuple[Json, tuple[int, ...]]:
        """Return the vehicle of a route of an answer, and the stops on its way."""
        name = route["vehicle"], route.get("shift", 0), route.get("route")
        vehicle = next(each for each in self.vehicles if name_of(each) == name)
        path = [int(stop) for stop in route["stops"]]
        begin = vehicle.get("start") is not None
        return vehicle, tuple(path[begin : len(path) - (vehicle.get("end") is not None)])

    def _measure(self, name: str, routes: list[Judged]) -> float | None:
        """Return a measure of a plan of these routes; None where breaks leave it open."""
        if any(each.best and each.best[0].breaks for each in routes) and name in _WITHOUT_BREAKS:
            return None
        visited = {stop for each in routes for stop in each.stops}
        compared = [each.compared for each in routes] or [0.0]
        goes = [each.taken for each in routes if each.taken]
        shares = [share for each in goes for share in each.shares]
        of_plan = {
            "longest": max(compared),
            "shortest": min(compared),
            "imbalance": max(compared) - min(compared),
            "unassigned": self._lost(visited),
            "on_time": sum(shares) / len(shares) if shares else None,
            "duration": sum(each.mean for each in goes),
            "duration_p90": percentile(goes, 90),
        }
        if name in of_plan:
            return of_plan[name]
        total = sum(self._own(each).summed(name, each.driven) for each in routes)
        return total + (len(self.promises.keys() - visited) if name == "changes" else 0)

    def _own(self, route: Judged) -> Lengths:
        return self.own.get(route.vehicle.get("profile"), self)._measured

    def _lost(self, visited: set[int]) -> float:
        return float(sum(self.stops[s].get("prize", 0.0) for s in self.clients if s not in visited))

    def _misreported(self, route: Json, judged: Judged) -> Iterator[str]:
        """Yield where the times that are told of a route are not the best, or wrong lengths."""
        if not _close(route["lengths"], judged.lengths, 1.0):
            yield f"lengths {route['lengths']} are {judged.lengths}: {route}"
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


def name_of(vehicle: Json) -> tuple[str, int, int | None]:
    """Return the id of a type of vehicles, its shift, and the promised route that it has."""
    return vehicle["id"], vehicle["number"], vehicle.get("route")


def _with_matrices(request: Json) -> Json:
    """Return a request whose costs that change or spread have a matrix."""
    objectives = [with_means(each) for each in request["objectives"]]
    return with_days(
        {**request, "objectives": objectives, "clock": with_means(request.get("clock"))}
    )


def _close(numbers: Any, others: Any, reach: float) -> bool:
    return len(numbers) == len(others) and all(
        isclose(a, b, rel_tol=CLOSE, abs_tol=CLOSE * max(1e-6, reach))
        for a, b in zip(numbers, others, strict=True)
    )
