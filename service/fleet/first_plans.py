"""First plans of a fleet: the tours of a network, cut into routes without any search."""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from math import inf

import numpy as np

from service.construction.first_tours import MIN_CONSTRUCTED, Constructor, construct
from service.errors import Refusal
from service.fleet.conflicts import FEW_STOPS
from service.fleet.evaluation import plan_lengths
from service.fleet.fleet import LAYERS, Array, Fleet, prices_of
from service.fleet.left_out import with_all_stops
from service.fleet.optimal_split import (
    Indices,
    RouteCosts,
    best_split,
    most_stops,
    plan_of,
    route_table,
    states_of,
    stock_of,
)
from service.fleet.plans import Plan, Route
from service.fleet.rules import Rules
from service.fleet.search.problem import Problem, problem_of
from service.fleet.vehicles import VehicleType, Visit
from service.instance import Instance
from service.objectives import OBJECTIVES
from service.preferences import spread

_TOURS = 21  # the number of evenly spread preferences
_WEIGHTS = 15  # of more than two objectives
_MOST_ROUTES = 2**22  # routes in the tables of all sequences together: 64 MB
_MOST_STEPS = 2e8  # steps of the dynamic program of a sequence: tenths of a second
_CYCLIC_STEPS = 1e7  # most steps with which every begin is tried; else only the first is
_ALL_STEPS = 5e9  # steps of all cuts together
_FEWEST = 20  # the least number of limits or weights, even if cuts are slow
_STEEPEST = 1e3  # weight of one scaled objective if the other has weight 1
_LEAST_SCALE = 1e-290  # least scale relative to the other's: its weight must be finite
_ROUNDING = 1e-9  # relative, for a gain


def network_sequences(fleet: Fleet, constructor: Constructor) -> list[Indices]:
    """Return the different tours of a network through all stops to visit, shape (c,) each.

    They begin after the depot of the first type of vehicles, if it has one.

    Args:
        constructor: The network, which must read matrices.

    Raises:
        Cancelled: The network was told to stop.
        InvalidInstance: Costs are too far apart for it.
    """
    clients = np.array(fleet.rules.clients, np.int64)
    vehicle = fleet.rules.vehicles[0]
    depot = vehicle.end if vehicle.start is None else vehicle.start
    places = clients if depot is None else np.concatenate(([depot], clients))
    if len(places) < MIN_CONSTRUCTED:
        return [clients]
    costs = fleet.among(places)
    if depot is not None and np.array_equal(costs[0], costs[1]):
        # If both costs are equal, every preference leads to the same tour.
        costs = np.stack((costs[0], _angular_costs(costs[0])))
    tours = construct(constructor, Instance(matrices=costs), spread(_TOURS))
    begun = [np.roll(tour, -int(tour.argmin())) for tour in tours]
    different = np.unique(np.array(begun, np.int64).reshape(-1, len(places)), axis=0)
    return [places[tour] for tour in (different if depot is None else different[:, 1:])]


def without_changes(fleet: Fleet) -> Iterator[Fleet]:
    """Yield fleets to cut tours for, whose costs do not change over the day.

    Yield first one with the mean costs, and then one with the greatest times of the day: true times
    are never later than these, so no window is missed that is kept by them. A fleet without changes
    comes alone.
    """
    profiles, clock = fleet.profiles or (fleet.costs,), fleet.rules.clock
    yield Fleet.of_profiles(fleet.rules, profiles) if fleet.days else fleet
    if fleet.days and clock is not None:
        slowest = [costs.copy() for costs in profiles]
        for costs, day in zip(slowest, fleet.days, strict=True):
            costs[clock] = day[clock].greatest()
        yield Fleet.of_profiles(fleet.rules, slowest)


def _angular_costs(costs: Array) -> Array:
    """Return costs that are small between stops in the same direction from the first, the depot.

    They are the geometric mean of the cost and the sine of half the angle at the depot. The angle
    is that of a triangle whose sides are three costs. Tours of small costs sweep round the depot.

    Costs count as shares of the largest. A stop is as far from the depot as the mean of the ways
    there and back; without a way it is farthest. Forbidden legs stay forbidden.
    """
    allowed = np.isfinite(costs)
    shares = np.where(allowed, costs, 0.0)
    shares /= shares.max() or 1.0
    ways = allowed[0].astype(int) + allowed[:, 0]
    away = np.where(ways > 0, (shares[0] + shares[:, 0]) / np.maximum(ways, 1), 1.0)
    sides = away[:, np.newaxis] * away
    difference = away[:, np.newaxis] - away
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        squares = (shares**2 - difference**2) / (4 * sides)
    sines = np.sqrt(np.where(sides > 0, squares, 1.0).clip(0.0, 1.0))
    return np.where(allowed, np.sqrt(shares * sines), inf)


class Cutter:
    """Cuts sequences of stops into routes, again and again, and finds the best of all cuts.

    Args:
        sequences: At least one sequence of all c stops to visit, shape (c,); c is at least 1.
        stop: Called often; once it returns True, no further cuts are made.

    Raises:
        Refusal: The fleet has shipments, stops with several windows, breaks, or too many types and
            numbers of vehicles.
    """

    def __init__(
        self, fleet: Fleet, sequences: Sequence[Indices], stop: Callable[[], bool]
    ) -> None:
        rules = fleet.rules
        not_cut = {
            "shipments need a time_limit over 0: no cut of a tour keeps them": rules.shipments,
            "stops with a pick-up need a time_limit over 0: no cut of a tour keeps it": rules.takes,
            "stops with several windows need a time_limit over 0": any(
                len(visit.windows) > 1 for visit in rules.visits
            ),
            "breaks need a time_limit over 0": any(vehicle.breaks for vehicle in rules.vehicles),
            "max_distance and max_driving need a time_limit over 0": rules.capped,
        }
        for reason, given in not_cut.items():
            if given:
                raise Refusal("no-plan", reason=reason)
        self._fleet = fleet
        self._stop = stop
        problem = _from_begin(fleet)
        most = max(most_stops(problem, sequence) for sequence in sequences)
        routes = len(fleet.rules.vehicles) * len(sequences[0]) * most
        if routes > _MOST_ROUTES or routes * states_of(fleet.rules) > _MOST_STEPS:
            reason = "this many stops, types and numbers of vehicles need a time_limit over 0"
            raise Refusal("no-plan", reason=reason)
        self._stock = stock_of(fleet.rules)
        self._sequences = sequences[: _MOST_ROUTES // routes]
        self._tables = [route_table(problem, each, most) for each in self._sequences]
        steps = len(self._sequences) * routes * self._stock.states
        self._begins = most if steps * most <= _CYCLIC_STEPS else 1
        self._cuts = max(_FEWEST, int(_ALL_STEPS / (steps * self._begins)))  # there is time for

    def plans(self) -> Iterator[Plan]:
        """Yield the best cuts under many limits or weights; nothing if no cut keeps every rule."""
        rules = self._fleet.rules
        first_sum = np.eye(len(rules.over))[rules.over.index("sum")]
        if len(rules.over) > OBJECTIVES:
            return self._under_weights_and_limits()
        if rules.swept is None:
            return self._under_weights()
        return self._under_limits(first_sum, rules.swept, self._cuts)

    def _under_weights_and_limits(self) -> Iterator[Plan]:
        """Yield the best plans under weights of more than two objectives, and under limits."""
        rules = self._fleet.rules
        weighed = [over in ("sum", "vehicles", "unassigned") for over in rules.over]
        weights = np.zeros((_WEIGHTS if sum(weighed) > 1 else 1, len(rules.over)))
        weights[:, weighed] = np.square(spread(len(weights), sum(weighed)))
        for each in weights / self._fleet.scale:
            if rules.swept is not None:
                yield from self._under_limits(each, rules.swept, self._cuts // len(weights))
            elif cut := self._best(self._costs(each)):
                yield cut[0]

    def _under_limits(self, weights: Array, limited: int, cuts: int) -> Iterator[Plan]:
        """Yield the plan of the least sum under each limit, from no limit to the least possible.

        Each limit is just below the longest route of the plan before (the epsilon-constraint
        method). If cuts are slow, limits are farther apart, so that there is time for all of them.
        """
        costs = self._costs(weights, limited)
        least = float(np.nextafter(self._least_limit(limited), inf))
        limit, apart = inf, 0.0
        while cut := self._best(costs, limit):
            plan, longest = cut
            yield plan
            if not plan.routes:  # all stops are left out: no lower limit changes this plan
                return
            if limit == inf:
                apart = (longest - least) / max(1, cuts)
            limit = min(longest, max(limit - apart, least))

    def _under_weights(self) -> Iterator[Plan]:
        """Yield the plans at both ends, and those on the hull between (Aneja and Nair, 1979)."""
        scale = self._fleet.scale
        scale = np.maximum(scale / (scale.max() or 1.0), _LEAST_SCALE)
        steepest = np.array([[_STEEPEST, 1.0], [1.0, _STEEPEST]]) / scale
        ends = [cut[0] for weights in steepest if (cut := self._best(self._costs(weights)))]
        yield from ends
        edges = deque([tuple(ends)] if len(ends) == OBJECTIVES else [])
        left = self._cuts
        while edges and left:
            left -= 1
            a, b = edges.popleft()
            lengths = np.array([plan_lengths(self._fleet, a), plan_lengths(self._fleet, b)])
            weights = np.array([lengths[0, 1] - lengths[1, 1], lengths[1, 0] - lengths[0, 0]])
            cut = self._best(self._costs(weights)) if (weights > 0).all() else None
            if cut is None:
                continue
            plan, _ = cut
            if weights @ plan_lengths(self._fleet, plan) < (1 - _ROUNDING) * (weights @ lengths[0]):
                yield plan
                edges += [(a, plan), (plan, b)]

    def _best(self, costs: Sequence[RouteCosts], limit: float = inf) -> tuple[Plan, float] | None:
        """Return the cheapest cut whose routes are all shorter than a limit, or None.

        With the plan comes the length of its longest route in the objective to bound.
        """
        least, found = inf, None
        for number, routes in enumerate(costs):
            if self._stop():
                return None
            cost, chosen = best_split(self._stock, routes, self._begins, limit)
            if cost < least:
                least, found = cost, (number, chosen)
        if found is None:
            return None
        number, chosen = found
        vehicles, places, counts = chosen.T
        longest = costs[number].bounded[vehicles, places, counts - 1].max(initial=0.0)
        return (plan_of(self._sequences[number], chosen), float(longest))

    def _least_limit(self, limited: int) -> float:
        """Return the least limit in these costs that lets each stop have a route of its own."""
        alone = self._tables[0][:, :, 0, limited].min(axis=0)
        required = [self._fleet.rules.visits[stop].prize is None for stop in self._sequences[0]]
        return float(alone[required].max(initial=0.0))

    def _costs(self, weights: Array, limited: int | None = None) -> list[RouteCosts]:
        """Return the costs of all routes along each sequence.

        Args:
            weights: The weight of each objective, shape (m,). The first includes fixed costs, and
                prizes if these are not an objective. Only sums, vehicles and prizes have a weight.
            limited: The number of the costs in which routes are bounded, if they are.
        """
        rules = self._fleet.rules
        by_layer = np.zeros(LAYERS)
        for index, (over, layer) in enumerate(zip(rules.over, rules.layers, strict=True)):
            if over == "sum" and not (index == 0 and rules.priced):
                by_layer[layer] += weights[index]
        prices = weights[0] * prices_of(rules)[:, np.newaxis, np.newaxis]
        each_vehicle = weights[rules.over.index("vehicles")] if "vehicles" in rules.over else 0.0
        lost = weights[rules.over.index("unassigned") if "unassigned" in rules.over else 0]
        fixed = np.array([vehicle.fixed for vehicle in rules.vehicles])[:, np.newaxis, np.newaxis]
        found = []
        for table, sequence in zip(self._tables, self._sequences, strict=True):
            feasible = np.isfinite(table[..., 0])
            lengths = np.where(feasible[..., np.newaxis], table, 0.0)
            prizes = (rules.visits[stop].prize for stop in sequence)
            skipping = [inf if prize is None else lost * prize for prize in prizes]
            bounded = np.zeros(feasible.shape) if limited is None else lengths[..., limited]
            extra = weights[0] * fixed + each_vehicle
            summed = lengths @ by_layer
            if rules.priced:
                summed += (lengths * prices).sum(axis=-1)
            cost = np.where(feasible, summed + extra, inf)
            # The compiled code expects this layout.
            found.append(RouteCosts(cost, np.ascontiguousarray(bounded), np.array(skipping)))
        return found


def plain_plans(fleet: Fleet, stop: Callable[[], bool]) -> Iterator[Plan]:
    """Yield plans that take tenths of a second, for when a search had none: they may break rules.

    One route first, then that route cut in the best places; for few stops also the plan into which
    one after the other is inserted where it costs the least.
    """
    plan = _one_route(fleet)
    yield plan
    if plan.routes and not fleet.rules.shipments:
        try:
            cutter = Cutter(fleet, [np.array(plan.routes[0].stops, np.int64)], stop)
        except Refusal:  # it cannot be cut
            pass
        else:
            yield from islice(cutter.plans(), 1)
    if len(fleet.rules.clients) <= FEW_STOPS:
        yield with_all_stops(fleet, Plan(()))


def _one_route(fleet: Fleet) -> Plan:
    """Return the plan in which one of the largest vehicles goes to the nearest stop each time.

    What a shipment picks up is delivered at once. O(n^2), so that there is time for it when there
    was none for a search. It may break rules.
    """
    rules = fleet.rules
    vehicle = max(range(len(rules.vehicles)), key=lambda index: rules.vehicles[index].capacity)
    deliveries = {each.pickup: each.delivery for each in rules.shipments}
    left = [stop for stop in rules.clients if stop not in deliveries.values()]
    position, stops = rules.vehicles[vehicle].start, list[int]()
    while left:
        stop = left.pop(0 if position is None else int(_away(fleet, position)[left].argmin()))
        stops += [stop, deliveries[stop]] if stop in deliveries else [stop]
        position = stops[-1]
    return Plan((Route(vehicle, tuple(stops)),) if stops else ())


def _away(fleet: Fleet, stop: int) -> Array:
    """Return what the legs from a stop cost in both costs together, in largest legs, shape (n,)."""
    first, second = np.where(fleet.largest_legs > 0, fleet.largest_legs, 1.0)
    with np.errstate(over="ignore"):
        return fleet.legs_from(0, stop) / first + fleet.legs_from(1, stop) / second


def _from_begin(fleet: Fleet) -> Problem:
    """Return the arrays of a fleet, with its mean costs, and times from the earliest departure.

    The tolerance of lateness is relative to times: for seconds since 1970 it would be a second.
    """
    problem = problem_of(fleet)._replace(day=None)
    if fleet.rules.clock is None:
        return problem
    begin = _begin(fleet.rules, float(fleet.largest_legs[fleet.rules.clock]))
    names = ("opens", "closes", "release", "departs", "leaves_by", "returns")
    times = {name: np.maximum(0.0, getattr(problem, name) - begin) for name in names}
    return problem._replace(**times)


def warm_up() -> None:
    """Compile the optimal split, or load it from the cache."""
    rules = Rules(visits=(Visit(), Visit()), vehicles=(VehicleType(start=0, end=0),))
    fleet = Fleet(rules=rules, costs=np.ones((LAYERS, rules.n, rules.n)))
    list(Cutter(fleet, [np.array([1])], lambda: False).plans())


def _begin(rules: Rules, leg: float) -> float:
    """Return a time before which no vehicle needs to leave, if legs are at most this long."""
    if rules.leave == "early":
        return min(vehicle.shift[0] for vehicle in rules.vehicles)
    route = rules.n * leg + sum(visit.longest_service for visit in rules.visits)
    first = min((time for span in rules.spans for time in span if 0 < time < inf), default=0.0)
    return max(0.0, first - route, min(vehicle.shift[0] for vehicle in rules.vehicles))
