"""Search for the front of a fleet by ruin and recreate, from one direction to the next."""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np

from service.day.costs import CostsOfDay
from service.errors import Cancelled
from service.fleet.conflicts import no_plan
from service.fleet.evaluation import violations
from service.fleet.fleet import LAYERS, Array, Fleet
from service.fleet.fronts import FleetOptions, front_of, reference_point_of
from service.fleet.plans import FleetFront, Plan, Route, kept_share, steps_of
from service.fleet.rules import Rules
from service.fleet.search.annealing import anneal
from service.fleet.search.directions import Directions, Step
from service.fleet.search.found import Driven, Found, offer
from service.fleet.search.kept_plan import KEPT, with_kept
from service.fleet.search.problem import Nodes, Problem, loosened, problem_of
from service.fleet.search.recreate import FAR, NEAR, RANDOM, SOON, insert_all, set_prices
from service.fleet.search.rows import clear, load_row, write_point, write_row
from service.fleet.search.ruin import limit_routes
from service.fleet.search.spreading import weight_of_variance
from service.fleet.search.working_plan import (
    MISSING,
    State,
    make_working_plan,
    total_cost,
)
from service.fleet.units import Units
from service.fleet.vehicles import VehicleType, Visit
from service.front import Termination
from service.search.archive.layout import make_archive, rows_of
from service.search.best_subset import best_subset, selection_limit, selection_seconds
from service.search.front_points import FrontPoints
from service.watch import Watch

RUINS = 100  # in a round
BRIEF = 0.25  # seconds to find what is in the way where there is no plan
_CALL = 0.003  # seconds that compiled code may run before the time is checked
_STILL = 0.1  # share of the rounds of a step at its end that accept nothing that is worse
_UNSURE = 0.05  # share of the time of a step, in which its pace is not yet known
_FIRST_ORDERS = NEAR, FAR, SOON, RANDOM  # in which the stops of a first plan are inserted
_ATTEMPTS = 3  # at a first plan: of many stops some find every place passed by at random
_FEW_STOPS = 12  # up to this number of stops, the search ends once it finds nothing more
_IDLE_STEPS = 72  # steps without a new plan, after which it ends
_FORGOTTEN = 0.9  # decay of the longest pause between two checks of the time, per check
# With fewer plans, and fewer stops looked at (all in each round), a search goes on after its
# deadline: a process that is held up else finds no plan.
_LEAST_PLANS, _LEAST_WORK = 10, 2000
_GRACE = 0.03  # seconds after the deadline, at the latest, when it ends all the same with a plan
_LONG_GRACE = 1.0  # the same without one
_CHECKING = 1e-5  # seconds for each stop of each plan, twice what a 2.5 GHz Xeon takes
_CHECKING_OF_DAY = 6e-5  # the same, over the day
_EXPLAINING = 1e-5  # seconds for each stop that is left out, per stop of the fleet
_MOST_EXPLAINING = 0.05  # share of the time limit for that


class RuinSearch:
    """A search by ruin and recreate, in all of whose directions one archive grows.

    Args:
        fleet: The fleet.
        options: The options of the front and the search.
        watch: Says when to end and to report.
    """

    def __init__(self, fleet: Fleet, options: FleetOptions, watch: Watch[FleetFront]) -> None:
        units = Units.of(fleet)
        self._fleet = fleet
        self._options = options
        self._watch = watch
        self._reference_point = units.points(reference_point_of(fleet, options))
        self._checked = 0.0
        self._pause = 0.0  # the longest recent seconds between two checks of the time
        self._cancelled = False
        self._problem = problem_of(units.fleet)
        self._working = make_working_plan(self._problem, options.seed)
        objectives = len(fleet.rules.over)
        width = _width(self._problem)
        driven = _driven(self._problem, options.driven)
        self._archives = Found(
            plans=make_archive(width, objectives),
            kept=make_archive(width, objectives, 16 if driven.most < 0 else 1000),
            driven=driven,
            point=np.zeros(objectives),
            row=np.full(width, -1, np.int32),
        )
        self._directions = Directions(
            units.fleet,
            np.random.default_rng(options.seed),
            lambda: self.points,
            self._left,
            lambda: self._lacked,
            RUINS,
        )
        self._ruins = 0
        self._most_ruins = options.iterations * RUINS
        self._lacked = 0  # stops, at the least in this step
        self._began = 0.0
        self._sorted = 0, np.empty(0, np.int32)

    @property
    def points(self) -> Array:
        """The lengths of all nondominated plans so far, shape (k, m), by ascending first length."""
        points: Array = self._archives.plans.points[self._rows]
        return points

    @property
    def _rows(self) -> Nodes:
        """The rows of all points in the archive."""
        inserted = int(self._archives.plans.counts[2])
        if self._sorted[0] != inserted:
            self._sorted = inserted, rows_of(self._archives.plans)
        return self._sorted[1]

    def __len__(self) -> int:
        """Return the number of nondominated plans so far."""
        return int(self._archives.plans.counts[0])

    def plan_at(self, index: int) -> Plan:
        """Return the plan of a point."""
        return _plan_of(self._archives.plans.tours[self._rows[index]])

    def _kept(self) -> tuple[Array, list[Plan]]:
        kept, driven = self._archives.kept, self._options.driven
        assert driven is not None
        plans = {row: _plan_of(kept.tours[row]) for row in rows_of(kept).tolist()}
        rows = [row for row, plan in plans.items() if kept_share(driven, plan) >= KEPT]
        return kept.points[rows], [plans[row] for row in rows]

    def _fewest_left_out(self) -> int:
        if not len(self) or not np.isfinite(self._problem.prize).any():
            return 0
        rows = self._archives.plans.tours[self._rows]
        visited = (self._problem.visited[rows] & (rows >= 0)).sum(axis=1).max()
        return len(self._problem.clients) - int(visited)

    def begin_with(self, plan: Plan) -> None:
        """Start from a plan that keeps every rule."""
        load_row(self._state_of(self._directions.first()), self._row_of(plan))
        self._offer()

    def _row_of(self, plan: Plan) -> Nodes:
        row = np.full(_width(self._problem), -1, np.int32)
        written = [stop for r in plan.routes for stop in (-2 - r.vehicle, *r.stops)]
        row[: len(written)] = written
        return row

    def run(self) -> Termination:
        """Search until nothing is left to do, the time is over, or the watch says to stop."""
        if self._watch.stopped():
            self._cancelled = True
            return "cancelled"
        if not len(self):
            self._insert_all()
        self._began = self._watch.spent
        for step in self._steps():
            if self._search(step):
                return "cancelled" if self._cancelled else "time_limit"
        return "converged"

    def front(self, size: int, terminated: Termination | None) -> FleetFront:
        """Return the best front found so far, of at most `size` plans.

        Raises:
            Refusal: No plan was found.
            Cancelled: No plan was found before the watch said to stop.
        """
        points = self.points
        indices, known = FrontPoints.among(points, self._reference_point)
        seconds = selection_limit(self._options.time_limit)
        chosen = indices[best_subset(known, size, seconds)]
        found = [self.plan_at(index) for index in chosen.tolist()]
        plans = [plan for plan in found if not violations(self._fleet, plan)]
        if not plans and self._cancelled:
            raise Cancelled
        if not plans:
            sentence = f"no plan was found in {self._options.time_limit:g} s that keeps every rule"
            raise no_plan(self._fleet, sentence, self._watch.lasting(BRIEF).ended)
        front = front_of(self._fleet, self._options, plans, terminated, self._watch)
        front = replace(front, found=max(front.found, len(points)))
        driven = self._options.driven
        if driven is None:
            return front
        return with_kept(front, driven, size, self._kept(), points)

    def _state_of(self, step: Step) -> State:
        return State(self._problem, self._working, step.direction)

    def _insert_all(self) -> None:
        """Make a first plan, which may leave out stops: the best of some orders of insertion."""
        state, row = self._state_of(self._directions.first()), self._archives.row
        best, least = row.copy(), math.inf
        for order in _FIRST_ORDERS:
            if least < math.inf and self._watch.over(0.0):
                break
            clear(state)
            set_prices(state)
            for _ in range(_ATTEMPTS):
                if self._working.counts[MISSING]:
                    insert_all(state, order)
            if (cost := total_cost(self._working)) < least:
                least = cost
                write_row(self._problem, self._working, row)
                best[:] = row
        kept = load_row(state, best)
        if kept and self._working.counts[MISSING] == 0 and not self._problem.bounded_below:
            self._offer()

    def _offer(self) -> None:
        write_point(self._problem, self._working, self._archives.point)
        offer(self._problem, self._working, self._archives)

    def _steps(self) -> Iterator[Step]:
        """Yield the directions; for few stops, until they lead to nothing new."""
        yield self._directions.first()
        idle, inserted = 0, -1
        for step in self._directions.steps():
            yield step
            now = int(self._archives.plans.counts[2])
            idle = idle + 1 if now == inserted else 0
            inserted = now
            few = len(self._problem.clients) <= _FEW_STOPS
            if few and len(self) and idle >= _IDLE_STEPS:
                return

    def _search(self, step: Step) -> bool:
        """Search in a direction, and return whether to end."""
        problem = self._problem
        if self._ruins and not len(self) and self._fleet.rules.has_bounds:
            problem, step = loosened(problem), self._directions.loose(step)
        state, row = State(problem, self._working, step.direction), self._archives.row
        if step.start is None:
            write_row(self._problem, self._working, row)
        else:
            row[:] = self._archives.plans.tours[self._rows[step.start]]
        load_row(state, row)
        if step.direction.deviation > 0:
            state = _by_variance(state)
            load_row(state, row)
        limit_routes(state)
        set_prices(state)
        self._lacked = len(problem.clients)
        heat, done, most, ends = step.heat, 0, step.rounds * RUINS, self._ends_of(step)
        while done < most:
            if self._ruins >= self._most_ruins or self._ended():
                return True
            most = self._in_time(done, most, ends)
            cooling = (step.cooled / max(heat, step.cooled)) ** (1 / (most - done))
            still = RUINS * max(1, int(_STILL * most / RUINS))
            until = most - still if done < most - still else most
            heat = heat if until < most else 0.0
            ruins = min(until - done, self._most_ruins - self._ruins, self._at_once())
            heat, made = anneal(state, self._archives, ruins, heat, cooling, step.ends_whole)
            self._ruins += made
            self._lacked = min(self._lacked, int(self._working.counts[MISSING]))
            done = done + ruins if made == ruins else most
        return False

    def _ends_of(self, step: Step) -> tuple[float, float]:
        """Return when a step begins, and when it has had its share of the time that is left.

        Where the number of iterations ends the search first, only they count.
        """
        now, left = self._watch.spent, self._left()
        if not left or left * RUINS >= self._most_ruins - self._ruins:
            return now, math.inf
        return now, now + self._watch.left * min(1.0, step.rounds / left)

    def _in_time(self, done: int, most: int, ends: tuple[float, float]) -> int:
        """Return how many ruins a step has in its time, once its pace is known."""
        began, until = ends
        now = self._watch.spent
        if until == math.inf or now - began < _UNSURE * (until - began):
            return most
        return done + max(1, int(done * (until - now) / (now - began)))

    def _at_once(self) -> int:
        """Return for how many ruins there is time before the time is checked.

        One may take ten milliseconds: over the day, with many breakpoints.
        """
        spent = self._watch.spent - self._began
        return max(1, int(_CALL * self._ruins / spent)) if spent > 0 else 1

    def _left(self) -> float:
        """Return the number of rounds left, estimated from the time of earlier ones."""
        most: float = self._most_ruins - self._ruins
        if self._watch.seconds < math.inf and self._ruins:
            spent = self._watch.spent - self._began
            most = min(most, max(0.0, self._watch.left) * self._ruins / max(spent, 1e-6))
        return most / RUINS

    def _ended(self) -> bool:
        """Return whether to stop, after a report if one is due."""
        watch, now = self._watch, self._watch.spent
        self._pause = max(now - self._checked, _FORGOTTEN * self._pause)
        self._checked = now
        if watch.stopped():
            self._cancelled = True
            return True
        worked = self._fleet.rules.n * self._ruins / RUINS >= _LEAST_WORK
        begun = len(self) >= _LEAST_PLANS or worked
        begun |= watch.over(-_GRACE if len(self) else -_LONG_GRACE)
        watch.report_if_due(self._found, partial(self.front, terminated=None))
        return begun and watch.over(self._reserve())

    def _found(self) -> tuple[float, int] | None:
        """Return the hypervolume and the number of plans found so far; None if there is none."""
        if not len(self):
            return None
        found = FrontPoints(self.points, self._reference_point)
        return found.quick_hypervolume, len(found)

    def _reserve(self) -> float:
        """Return the seconds for one more iteration, and for checking and selecting plans after it.

        The iteration is assumed to be as long as the longest recent one.
        """
        found, n = len(self), self._fleet.rules.n
        explained = min(
            _EXPLAINING * self._fewest_left_out() * n, _MOST_EXPLAINING * self._options.time_limit
        )
        each = _CHECKING if self._fleet.day is None else _CHECKING_OF_DAY
        checked = each * min(found, self._options.size) * n
        limit = selection_limit(self._options.time_limit)
        selected = selection_seconds(self._options.size, found, len(self._reference_point), limit)
        return self._pause + checked + explained + selected


def _by_variance(state: State) -> State:
    """Return a state whose direction weighs the variance of a plan in place of its deviation."""
    direction, plan = state.direction, state.plan
    weight = weight_of_variance(state.problem, plan, direction.deviation)
    return state._replace(direction=direction._replace(variance=weight))


def _width(problem: Problem) -> int:
    """Return the most numbers of a plan's row: its stops, a type for each route, and an end.

    Before each stop a vehicle may load again.
    """
    clients = len(problem.clients)
    return clients * (1 + problem.reloads) + min(len(problem.kind), clients) + 1


def _plan_of(row: Nodes) -> Plan:
    """Return the plan of a row, as write_row() writes it."""
    numbers = row[row != -1].tolist()
    begins = [place for place, number in enumerate(numbers) if number < 0]
    bounds = pairwise([*begins, len(numbers)])
    return Plan(
        tuple(Route(-2 - numbers[begin], tuple(numbers[begin + 1 : end])) for begin, end in bounds)
    )


def _driven(problem: Problem, plan: Plan | None) -> Driven:
    """Return a plan that is driven as arrays."""
    n = len(problem.demand)
    kind, before = np.full(n, -1, np.int32), np.full(n, -1, np.int32)
    steps = set() if plan is None else set(steps_of(plan))
    for vehicle, previous, stop in steps:
        kind[stop] = vehicle
        before[stop] = -1 if previous is None else previous
    # The steps to where a vehicle loads are not counted on the way: a plan may keep them all.
    loads = sum(not problem.visited[stop] for _, _, stop in steps)
    most = max(0, math.ceil(KEPT * len(steps)) - loads)
    return Driven(kind, before, -1 if plan is None else most)


def warm_up() -> None:
    """Compile the search, or load it from the cache."""
    rules = _small_rules(None)
    _run_briefly(Fleet(rules=rules, costs=np.ones((LAYERS, rules.n, rules.n))))


def warm_up_over_the_day() -> None:
    """Compile the search over the day, or load it from the cache."""
    rules = _small_rules(0)
    times = CostsOfDay(np.arange(2.0), np.ones(2), np.arange(2), np.ones((2, rules.n, rules.n)))
    _run_briefly(Fleet.over_the_day(rules, times, times))


def _small_rules(clock: int | None) -> Rules:
    return Rules(
        visits=(Visit(),) * 4,
        vehicles=(VehicleType(start=0, end=0, count=2),),
        over=("sum", "max"),
        clock=clock,
    )


def _run_briefly(fleet: Fleet) -> None:
    RuinSearch(fleet, FleetOptions(time_limit=math.inf, iterations=3), Watch()).run()
