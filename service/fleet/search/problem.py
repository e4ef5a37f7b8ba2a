"""A fleet as the arrays that the search reads, and what a direction of the search asks for."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from service.fleet.fleet import Fleet
from service.fleet.loads import loads_of
from service.fleet.measures.table import Measure
from service.fleet.rules import Over, Rules
from service.fleet.search.day import FleetDay, day_of
from service.fleet.search.extras import Extras, Waits, extras_of, neighbours_of, waits_of
from service.fleet.vehicles import Pace, VehicleType
from service.jit import by_reference

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Nodes = NDArray[np.int32]
Flags = NDArray[np.bool_]

_NUMBERED: tuple[str, ...] = (*get_args(Over), *get_args(Measure))
SUM, MAX, VEHICLES, UNASSIGNED, IMBALANCE, OF_PROMISES = map(
    _NUMBERED.index, ("sum", "max", "vehicles", "unassigned", "imbalance", "changes")
)
# The columns of the values of a route.
FIRST, SECOND, OVERTIME, LATENESS, LOADED, RELEASED, EARLINESS, ARRIVAL = range(8)
OVERLAP, CHANGES, WEIGHED, LATE, MEAN, VARIANCE, MOST = range(8, 15)
COLUMNS = 15
# The columns of measures with a weight in directions; from EARLINESS on, see weighed.py.
WEIGHTED: Mapping[str, int] = {
    "overtime": OVERTIME,
    "lateness": LATENESS,
    "load_distance": LOADED,
    "earliness": EARLINESS,
    "weighted_arrival": ARRIVAL,
    "overlap": OVERLAP,
    "changes": CHANGES,
    "on_time": LATE,
}
NEIGHBOURS = 30  # of these, beside which it is tried first
_FORBIDDEN = 1e4  # cost of a forbidden leg, in the cost of a plan in which each leg is the largest


@by_reference
class Problem(NamedTuple):
    """A fleet of n stops, v types of vehicles and d dimensions of loads, under m objectives.

    A plan has at most r routes: a slot for each vehicle, in the order of the types. The ends of
    slot i are the nodes n + 2 i and n + 2 i + 1; all other nodes are stops.
    """

    # By profile: how some types of vehicles drive and serve.
    costs: Array  # (p, n, n, 2); (p, 0, 0, 2) where legs are lines
    places: Array  # (n, 2, 3), where stops are in each line; (0, 2, 3) where costs are stored
    curved: Flags  # (2,), whether each line is along a sphere
    factors: Array  # (p, 2), what a line of length 1 costs
    alike: bool  # whether both costs are the same
    day: FleetDay | None  # both costs over the day; `costs` are then their means
    clock: int  # the number of the costs that are time; -1 for none
    limited: int  # the number of the costs that `longest` bounds; -1 for none
    swept: int  # the number of the costs by which the longest route counts; -1 if it does not
    forbidden: float  # legs of this cost must not be taken
    demand: Indices  # (n, d)
    taken: Indices  # (n, d), what each stop puts on board, to the end
    takes: bool  # whether some stops do
    carries: bool  # whether there are these or shipments, so that the load may rise on the way
    service: Array  # (p, n), by profile
    held: Array  # (n,), how long a vehicle waits at least that reaches the stop just in time
    release: Array  # (n,)
    windows: Array  # (n, w, 2), by ascending begin; the last is repeated
    choice: bool  # whether a stop has several windows
    narrow: bool  # whether a window ends before it begins: see Rules.windows
    opens: Array  # (n,), the begin of the first, or its end if that is before
    closes: Array  # (n,), the end of the last
    due: Array  # (n,)
    weighs: bool  # whether an objective is one of those in weighed.py
    timely: bool  # whether an objective depends on when each visit begins
    wanted: Array  # (n,), before which a visit is early
    urgency: Array  # (n,), 0 for depots
    begin: float  # from when on weighted arrivals count
    extras: Extras
    prize: Array  # (n,), infinite where a stop must be visited
    near: Nodes  # (n, k), the nearest stops of each stop to visit, from the nearest on
    clients: Nodes  # (c,), the stops to visit
    visited: Flags  # (n,), whether each stop is one of them
    tasks: Nodes  # (t,), those that are inserted: all but deliveries, which come with pick-ups
    ships: bool  # whether there are shipments
    simple: bool  # whether only loads and times forbid places for stops
    shipped: Flags  # (n,), whether each stop is in one
    delivery: Nodes  # (n,), where the load of each pick-up goes; -1 for other stops
    pickup: Nodes  # (n,), where the load of each delivery is from
    place: Nodes  # (n + 2 r,), the stop at which each node is; -1 for anywhere
    kind: Indices  # (r,), the type of the vehicle of each slot
    profile: Indices  # (r,), and its profile
    slots: Indices  # (v + 1,), the first slot of each type
    capacity: Indices  # (v, d), without the initial load
    whole: Indices  # (v, d), with it
    reloads: bool  # whether some vehicles may load again
    reload: Indices  # (v, x), the stops at which each type may; -1 after the last
    trips: Indices  # (v,), the most trips of a route
    rests: Indices  # (v,), the number of breaks
    breaks: Array  # (v, b, 3), the earliest and the latest begin of each, and how long it takes
    initial: Indices  # (v,), the initial load in the first dimension
    early: bool  # whether vehicles leave as early as they may
    postpones: bool  # whether best departures are found when an iteration ends, and not before
    plain: bool  # whether times along routes follow from spans, one for each stop
    departs: Array  # (v,)
    leaves_by: Array  # (v,)
    returns: Array  # (v,), with overtime
    shift_end: Array  # (v,)
    longest: Array  # (v,)
    most_length: Array  # (v,), the same, where a loose search may exceed it: see loosened()
    most_overtime: Array  # (v,)
    fixed: Array  # (v,)
    mixed: bool  # whether types of vehicles differ in what they hold, cost or take
    priced: bool  # whether the first length is at prices
    per_distance: Array  # (v,), the price of a unit of the first costs
    per_time: Array  # (v,), and of the time of a route
    over: Indices  # (m,), by _NUMBERED
    column: Indices  # (m,), of the values of a route
    grouped: bool  # whether stops ride together, or must not
    mates: Nodes  # (n, x), the stops that ride with each; -1 after the last
    rivals: Nodes  # (n, y), the stops that must not ride with each; -1 after the last
    ordered: bool  # whether stops have an order
    earlier: Flags  # (n, n), whether the first comes before the second; (1, 1) if none does
    waits: Waits  # where there are any, `windows`, `opens` and `closes` change with the plan
    grows: bool  # whether a route with one more stop costs as much as its legs alone, at least
    bounded_below: bool  # whether a route may have too few stops, or be too short
    min_stops: Indices  # (v,)
    shortest: Array  # (v,)
    capped: bool  # whether the costs of legs are bounded by themselves
    most_legs: Array  # (v, 2), the most of both costs of a route's legs
    tried: Flags  # (v,), whether only a trial says what a stop costs in a route


def problem_of(fleet: Fleet) -> Problem:
    """Return the arrays of a fleet."""
    rules, loads = fleet.rules, loads_of(fleet.rules)
    visits, vehicles, windows = rules.visits, rules.vehicles, _windows(rules)
    weighs = rules.of_days or any(WEIGHTED.get(over, FIRST) >= EARLINESS for over in rules.over)
    opens, closes = windows[:, 0, 0], windows[:, -1, 1]
    clients = np.array(rules.clients, np.int32)
    delivery, pickup = _shipped(rules)
    near = neighbours_of(fleet, clients)
    counts = [min(vehicle.count, len(clients)) for vehicle in vehicles]
    kind = np.repeat(np.arange(len(vehicles)), counts)
    ends = [[-1 if end is None else end for end in (v.start, v.end)] for v in vehicles]
    forbidden = _FORBIDDEN * max(1.0, float(fleet.greatest_legs.max())) * (rules.n + 1)
    paces = list(map(rules.pace, range(len(vehicles))))
    profiles = list(dict.fromkeys(paces))
    forbidden *= max(1.0, *(1.0 / each.speed for each in profiles))
    places = [line.places for line in fleet.lines] or np.empty((2, 0, 3))
    factors = _floats([line.factor for line in fleet.lines])
    return Problem(
        costs=np.array([_costs(fleet, each, forbidden) for each in profiles]),
        places=np.ascontiguousarray(np.moveaxis(np.array(places), 0, 1)),
        curved=np.array([line.curved for line in fleet.lines], np.bool_),
        factors=np.array([_driven(rules, factors, each.speed, forbidden) for each in profiles]),
        alike=fleet.has_one_cost and (rules.clock is None or {each.speed for each in paces} == {1}),
        day=day_of(fleet, forbidden),
        clock=-1 if rules.clock is None else rules.clock,
        limited=-1 if rules.limited is None else rules.limited,
        swept=-1 if rules.swept is None else rules.swept,
        forbidden=forbidden,
        demand=loads.demand,
        taken=loads.taken,
        takes=rules.takes,
        carries=rules.takes or bool(rules.shipments),
        service=np.array([each.services for each in profiles]),
        held=np.maximum(0.0, opens - closes),
        release=_floats([visit.release for visit in visits]),
        windows=windows,
        choice=any(len(visit.windows) > 1 for visit in visits),
        narrow=bool((windows[:, :, 1] < windows[:, :, 0]).any()),
        opens=np.minimum(opens, closes),
        closes=closes.copy(),
        due=_floats([visit.due for visit in visits]),
        weighs=weighs,
        timely=bool(rules.of_begins),
        wanted=_floats([visit.wanted for visit in visits]),
        urgency=_floats([visit.urgency for visit in visits]),
        begin=float(rules.begin),
        extras=extras_of(fleet, forbidden, near[:, :NEIGHBOURS]),
        prize=_floats([np.inf if visit.prize is None else visit.prize for visit in visits]),
        near=near,
        clients=clients,
        visited=np.isin(np.arange(rules.n), clients),
        tasks=clients[pickup[clients] < 0],
        ships=bool(rules.shipments),
        simple=not (rules.shipments or rules.takes or rules.reloads or rules.groups),
        shipped=(delivery >= 0) | (pickup >= 0),
        delivery=delivery,
        pickup=pickup,
        place=np.concatenate((np.arange(rules.n), np.array(ends)[kind].ravel())).astype(np.int32),
        kind=kind,
        profile=np.array([profiles.index(each) for each in paces])[kind],
        slots=np.concatenate(([0], np.cumsum(counts))),
        capacity=loads.capacity - loads.initial,
        whole=loads.capacity,
        reloads=rules.reloads,
        reload=_padded([vehicle.reload for vehicle in vehicles]),
        trips=np.array([rules.n if v.max_trips is None else v.max_trips for v in vehicles]),
        rests=np.array([len(vehicle.breaks) for vehicle in vehicles]),
        breaks=_breaks(vehicles),
        initial=np.array([(each.initial_load or (0,))[0] for each in vehicles]),
        early=rules.leave == "early",
        postpones=fleet.day is not None and _postpones(rules),
        plain=rules.clock is not None and fleet.day is None and not weighs and _plain_times(rules),
        departs=_floats([vehicle.way[0] for vehicle in vehicles]),
        leaves_by=_floats([min(v.leaves_by, v.way[1]) for v in vehicles]),
        returns=_floats([vehicle.way[1] for vehicle in vehicles]),
        shift_end=_floats([vehicle.shift[1] for vehicle in vehicles]),
        longest=_floats([vehicle.longest for vehicle in vehicles]),
        most_length=_floats([vehicle.longest for vehicle in vehicles]),
        most_overtime=_floats([vehicle.max_overtime for vehicle in vehicles]),
        fixed=_floats([vehicle.fixed for vehicle in vehicles]),
        mixed=len({_worth(vehicle) for vehicle in vehicles}) > 1 or len(profiles) > 1,
        priced=rules.priced,
        per_distance=_floats([vehicle.per_distance for vehicle in vehicles]),
        per_time=_floats([vehicle.per_time for vehicle in vehicles]),
        over=np.array([_NUMBERED.index(over) for over in rules.over]),
        column=np.array([_column(rules, index) for index in range(len(rules.over))]),
        grouped=bool(rules.groups.mates or rules.groups.rivals),
        mates=_mates(rules),
        rivals=_rivals(rules),
        ordered=bool(rules.groups.ordered),
        earlier=_earlier(rules),
        waits=waits_of(rules, windows, len(kind)),
        grows=not (weighs or any(vehicle.is_bounded_below for vehicle in vehicles)),
        bounded_below=any(vehicle.is_bounded_below for vehicle in vehicles),
        min_stops=np.array([vehicle.min_stops for vehicle in vehicles]),
        shortest=_floats([vehicle.shortest for vehicle in vehicles]),
        capped=bool(rules.capped),
        most_legs=np.array([rules.most_legs(each) for each in range(len(vehicles))]),
        tried=np.array([_is_tried(fleet, vehicle) for vehicle in vehicles]),
    )


def _costs(fleet: Fleet, pace: Pace, forbidden: float) -> Array:
    """Return both costs of all legs to vehicles of a pace, shape (n, n, 2)."""
    costs = np.moveaxis(fleet.costs_by(pace.profile), 0, -1)
    return _driven(fleet.rules, costs, pace.speed, forbidden)


def _driven(rules: Rules, costs: Array, speed: float, forbidden: float) -> Array:
    """Return costs at a speed, shape (..., 2); of forbidden legs a finite cost."""
    driven = costs.copy()
    if rules.clock is not None and costs.size:
        driven[..., rules.clock] /= speed
    return np.where(np.isinf(driven), forbidden, driven)


def _worth(vehicle: VehicleType) -> tuple[float, ...]:
    """Return what a type of vehicles holds and costs."""
    return (*vehicle.capacity, vehicle.fixed, vehicle.per_distance, vehicle.per_time)


def loosened(problem: Problem) -> Problem:
    """Return a problem whose routes may be too long or end too late, at a price."""
    endless = np.full(len(problem.longest), np.inf)
    return problem._replace(longest=endless, returns=endless)


def _shipped(rules: Rules) -> tuple[Nodes, Nodes]:
    """Return the delivery of each pick-up, and the pick-up of each delivery; -1 for others."""
    delivery, pickup = np.full(rules.n, -1, np.int32), np.full(rules.n, -1, np.int32)
    for each in rules.shipments:
        delivery[each.pickup], pickup[each.delivery] = each.delivery, each.pickup
    return delivery, pickup


def _padded(rows: Sequence[Sequence[int]]) -> Indices:
    """Return rows of one length, with -1 after the last number of each."""
    padded = np.full((len(rows), max(map(len, rows))), -1)
    for row, numbers in zip(padded, rows, strict=True):
        row[: len(numbers)] = numbers
    return padded


def _mates(rules: Rules) -> Nodes:
    """Return the stops that ride with each stop, shape (n, x)."""
    mates = rules.groups.mates
    return _padded([[*(mates.get(i, frozenset()) - {i})] for i in range(rules.n)]).astype(np.int32)


def _rivals(rules: Rules) -> Nodes:
    """Return the stops that must not ride with each stop or those that ride with it, (n, y)."""
    rivals: list[set[int]] = [set() for _ in range(rules.n)]
    for stop, other in rules.groups.rivals:
        for mate in rules.groups.mates.get(stop, (stop,)):
            rivals[mate].add(other)
    return _padded([[*each] for each in rivals]).astype(np.int32)


def _earlier(rules: Rules) -> Flags:
    """Return which stops come before which others, shape (n, n)."""
    size = rules.n if rules.groups.ordered else 1
    earlier = np.zeros((size, size), np.bool_)
    for first, then in rules.groups.ordered:
        earlier[first, then] = True
    return earlier


def _breaks(vehicles: Sequence[VehicleType]) -> Array:
    """Return the breaks of each type of vehicles, shape (v, b, 3)."""
    found = np.zeros((len(vehicles), max(len(each.breaks) for each in vehicles), 3))
    for row, vehicle in zip(found, vehicles, strict=True):
        row[: len(vehicle.breaks)] = np.reshape(vehicle.breaks, (-1, 3))
    return found


def _is_tried(fleet: Fleet, vehicle: VehicleType) -> bool:
    """Return whether a stop in a route may cost something else than what is known along it says.

    It may where costs change over the day, where the vehicle has breaks, where the begin of each
    visit counts or how times spread, or where it loads again and times or loads on the way depend
    on what all of a trip brings.
    """
    rules = fleet.rules
    if rules.of_begins or rules.of_days or fleet.day is not None:
        return True
    if not vehicle.reload:
        return bool(vehicle.breaks)
    timed = any(v.release or v.due < np.inf or len(v.windows) > 1 for v in rules.visits)
    return bool(vehicle.breaks) or timed or "load_distance" in rules.over


def _plain_times(rules: Rules) -> bool:
    """Return whether a span for each stop, and no more, says when a route is where."""
    if rules.capped or rules.reloads or rules.groups.before or "lateness" in rules.over:
        return False
    several = any(len(windows) > 1 or windows[0][0] > windows[0][1] for windows in rules.windows)
    return not (several or min(rules.holds) < np.inf or any(v.breaks for v in rules.vehicles))


def _postpones(rules: Rules) -> bool:
    """Return whether a route that keeps all rules does so at its best departure too."""
    strict = rules.capped or rules.reloads or rules.groups.before
    return not (strict or any(vehicle.breaks for vehicle in rules.vehicles))


def _windows(rules: Rules) -> Array:
    """Return the windows of all stops; where there are fewer than most have, the last again."""
    most = max(map(len, rules.windows))
    padded = [windows + windows[-1:] * (most - len(windows)) for windows in rules.windows]
    return np.array(padded, np.float64)


def _floats(values: list[float]) -> Array:
    return np.array(values, np.float64)


def _column(rules: Rules, objective: int) -> int:
    """Return the column of the values of a route that an objective is of."""
    over = rules.over[objective]
    if over == "max" and rules.percent(objective) is not None:
        return MOST
    if over == "imbalance":
        assert rules.limited is not None
        return rules.limited
    return WEIGHTED.get(over, rules.layers[objective])


@by_reference
class Direction(NamedTuple):
    """What the search minimises: a weighted sum over routes, with limits on routes and plans.

    The weighted sum is that of legs or durations, vehicles, fixed costs and the measures in
    `WEIGHTED`, whose weights have their names, and of the prizes of stops outside. What exceeds a
    limit is multiplied by `penalty`. A plan also pays for what its lengths exceed bounds by.
    """

    costs: tuple[float, float]  # without prices
    vehicle: float
    fixed: float
    prize: float
    overtime: float
    lateness: float
    load_distance: float
    earliness: float
    weighted_arrival: float
    overlap: float
    changes: float
    on_time: float
    mean: float  # of the time of all routes, where that spreads
    deviation: float
    variance: float  # in place of the deviation, which is no sum over routes: see spreading.py
    longest: float  # the limit on the length of a route in the swept costs
    penalty: float
    most: float  # the limit on what a route does not exceed on most days
    most_penalty: float
    beyond: float  # price of each unit by which a route is too long or ends too late, if it may
    required: float  # price of a stop outside that must be visited, at first
    steady: bool  # whether that price rises only while the plan that is changed lacks a stop
    routes: int  # at most
    bounds: Array  # (m,), on the lengths of a plan
    strict: Array  # (m,), what a unit beyond them costs
