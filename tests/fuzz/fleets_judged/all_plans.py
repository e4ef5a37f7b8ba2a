"""Try all plans of a small fleet, to judge refusals and fronts."""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from itertools import combinations, permutations, product

from tests.fuzz.fleets_judged.judge import Judge, Judged
from tests.fuzz.fleets_judged.timeline import Json
from tests.fuzz.fleets_judged.waits import has_waits

Point = tuple[float, ...]
Routes = dict[frozenset[int], list[Judged]]


def exact_points(judge: Judge) -> list[Point]:
    """Return the points of all plans that no other plan dominates, in order."""
    routes = [_routes(judge, vehicle) for vehicle in judge.vehicles]
    found: set[Point] = set()
    for plan in _plans(judge, routes, tuple(judge.clients), [], Counter()):
        waits = has_waits(judge.request)
        beside = judge.beside([(each.vehicle, each.stops) for each in plan]) if waits else plan
        if not isinstance(beside, str):
            found.add(judge.lengths(beside))
    return undominated(sorted(found))


def undominated(points: list[Point]) -> list[Point]:
    """Return the points that no other one dominates, in their order."""
    return [p for p in points if not any(_dominates(q, p) for q in points)]


def _dominates(a: Point, b: Point) -> bool:
    return a != b and all(x <= y for x, y in zip(a, b, strict=True))


def _routes(judge: Judge, vehicle: Json) -> Routes:
    """Return the routes of a vehicle by the stops that they visit; of some that are alike, one."""
    found: Routes = defaultdict(list)
    compared = _compared(judge)
    reloads = [(), *((stop,) for stop in vehicle.get("reload", ()))]
    for count in range(1, len(judge.clients) + 1):
        for stops in permutations(judge.clients, count):
            for before in product(reloads, repeat=count):
                pairs = zip(before, stops, strict=True)
                route = tuple(each for reload, stop in pairs for each in (*reload, stop))
                judged = judge.route(vehicle, route)
                if has_waits(judge.request):
                    if not isinstance(judged, str) or judged == "shortest":
                        found[frozenset(stops)].append(Judged(vehicle, route, [], (), 0.0))
                elif not isinstance(judged, str):
                    _add(judged, found[frozenset(stops)], compared)
    return found


def _compared(judge: Judge) -> Callable[[Judged], Point]:
    """Return what decides how good a route is beside others: nothing of another is larger."""
    fair = any(each.get("measure") == "imbalance" for each in judge.objectives)
    of_days = any("percentile" in each for each in judge.objectives)

    def point(route: Judged) -> Point:
        longer = (-route.compared,) if fair else ()
        goes = route.taken if of_days else None
        days = () if goes is None else (goes.mean, goes.variance, *goes.days)
        return (*route.lengths, *longer, *days)

    return point


def _add(judged: Judged, routes: list[Judged], compared: Callable[[Judged], Point]) -> None:
    """Add a route unless another of the same stops is as good."""
    added = compared(judged)
    if not any(all(x <= y for x, y in zip(compared(r), added, strict=True)) for r in routes):
        routes.append(judged)


def _plans(
    judge: Judge,
    routes: list[Routes],
    left: tuple[int, ...],
    chosen: list[Judged],
    used: Counter[int],
) -> Iterator[list[Judged]]:
    """Yield all plans that visit the stops left, with the routes chosen so far."""
    if not left:
        yield chosen
        return
    first, *others = left
    if judge.prize(first) is not None:
        partner = {**dict(judge.rules.shipments), **judge.rules.pickup_of}.get(first)
        rest = tuple(stop for stop in others if stop != partner)
        yield from _plans(judge, routes, rest, chosen, used)
    for count in range(len(others) + 1):
        for more in combinations(others, count):
            stops = frozenset((first, *more))
            rest = tuple(stop for stop in others if stop not in stops)
            for index, each in enumerate(routes):
                if used[index] < judge.vehicles[index].get("count", 1):
                    for route in each.get(stops, ()):
                        more_used = used + Counter((index,))
                        yield from _plans(judge, routes, rest, [*chosen, route], more_used)
