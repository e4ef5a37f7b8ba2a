"""plan_fleet(...): from a fleet to its front of plans."""

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from itertools import chain
from math import inf

import numpy as np
import pyvrp

from service.construction.first_tours import Constructor
from service.errors import Cancelled, Refusal
from service.fleet.archive import KeptPlans, SolutionArchive
from service.fleet.conflicts import no_plan
from service.fleet.enumeration import MOST_STOPS, exact_plans, is_enumerable, some_plan
from service.fleet.evaluation import points_of, violations
from service.fleet.first_plans import Cutter, network_sequences, plain_plans
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions, front_of, reference_point_of
from service.fleet.goal import FREE, Goal
from service.fleet.left_out import with_all_stops
from service.fleet.measure_sweep import MeasureSweep
from service.fleet.mixed_sweep import MixedSweep
from service.fleet.moves import Mover
from service.fleet.necessary import check_necessary
from service.fleet.plans import FleetFront, Plan
from service.fleet.rules import Rules
from service.fleet.scales import Units
from service.fleet.solver import Solver
from service.fleet.sweep import Searches, SumSweep
from service.fleet.translation import Translation
from service.front import Termination
from service.search.best_subset import best_subset, selection_limit, selection_seconds
from service.search.front_points import FrontPoints
from service.watch import Watch

_FORGOTTEN = 0.9  # decay of the longest pause between two checks of the time, per check
_ENUMERATING = 0.5  # share of the time limit, after which the search replaces enumeration
_TRYING = 0.9  # share of the time limit, until when routes are tried if a search found no plan
_LEAST_TRYING = 0.1  # seconds for that
_FINDING_FAULTS = 0.1  # share of the time limit for necessary conditions
_BRIEF = 0.25  # seconds for them without a time limit, and to find what is in the way after it
# With fewer plans, and fewer stops looked at (all in each iteration), a search goes on after its
# deadline: a process that is held up else finds no plan.
_LEAST_PLANS, _LEAST_WORK = 10, 2000
_GRACE = 0.03  # seconds after the deadline, at the latest, when it ends all the same
_FIRST = 1.5e-7  # seconds per pair of stops until PyVRP has its first solution
_CHECKING = 1e-5  # seconds for each stop of each plan, twice what a 2.5 GHz Xeon takes
_EXPLAINING = 1e-5  # seconds for each stop that is left out, per stop of the fleet
_MOST_EXPLAINING = 0.05  # share of the time limit for that


def plan_fleet(
    fleet: Fleet,
    options: FleetOptions,
    constructor: Constructor | None = None,
    watch: Watch[FleetFront] | None = None,
) -> FleetFront:
    """Return the best front of plans found for a fleet within the time limit.

    Args:
        fleet: The fleet.
        options: The options of the front and the search.
        constructor: The network whose tours are cut into plans where the time limit is 0; it must
            read matrices. A search does not ask it: its fronts are as good without.
        watch: Asked after each iteration of PyVRP, that is every few milliseconds, whether to
            stop; planning then ends with the best front so far. It also says when to report. The
            time limit is that of the options.

    Raises:
        NoTour: Some stops cannot be visited under the rules. The refusal names them.
        Refusal: `no-plan`: no plan keeps every rule, or none was found in time. If no rule can be
            broken, a plan is always found. `no-actor`: the time limit is 0 and there is no network.
            `invalid-instance`: costs, prizes and times are too far apart for whole numbers.
        InvalidInstance: The time limit is 0, and costs are too far apart for the network.
        Cancelled: The watch said to stop before a plan was found.
        ValueError: A component of the reference point is not positive, or the size is below 1.
    """
    watch = (watch or Watch()).lasting(options.time_limit)
    check_necessary(fleet, watch.until(_FINDING_FAULTS * watch.seconds or _BRIEF).ended)
    if is_enumerable(fleet.rules):
        all_plans = exact_plans(fleet, watch.until(_ENUMERATING * watch.seconds or _BRIEF).ended)
        if all_plans is not None:
            if not all_plans:
                sentence = "no plan keeps every rule: all were tried"
                raise no_plan(fleet, sentence, watch.until(watch.seconds or 2 * _BRIEF).ended)
            return front_of(fleet, options, all_plans, "converged", watch)
    if options.time_limit == 0:
        return _without_search(fleet, options, constructor, watch)
    return _searched(fleet, options, watch)


def _without_search(
    fleet: Fleet,
    options: FleetOptions,
    constructor: Constructor | None,
    watch: Watch[FleetFront],
) -> FleetFront:
    """Return the front of the plans of the network, and of the plan that is driven, if one is."""
    driven = None if options.driven is None else _completed(fleet, options.driven)
    kept = [] if driven is None else [driven]
    try:
        plans = _constructed(fleet, constructor, watch)
    except Refusal:
        if not kept:
            raise
        plans = []
    return front_of(fleet, options, [*kept, *plans], "converged", watch, constructed=len(plans))


def _completed(fleet: Fleet, plan: Plan) -> Plan | None:
    """Return a plan if it breaks no rule, else with the stops that it lacks; None if that does."""
    if not violations(fleet, plan):
        return plan
    whole = with_all_stops(fleet, plan)
    return None if violations(fleet, whole) else whole


def _searched(fleet: Fleet, options: FleetOptions, watch: Watch[FleetFront]) -> FleetFront:
    """Return the front that a search finds; if it found none, a front of one plain plan."""
    search = _Search(fleet, options, watch)
    if options.driven is not None:
        search.begin_with(options.driven)
    search.begin_plainly()
    terminated = search.run()
    plans: Iterable[Plan] = ()
    if not search.archive and terminated != "cancelled" and fleet.rules.has_bounds:
        search = _Search(fleet, options, watch, loose=True)
        if plan := _tried(fleet, watch):
            plans = [plan]
            search.begin_with(plan)
        terminated = search.run()
    if not search.archive and terminated != "cancelled":
        for plan in chain(plans, plain_plans(fleet, watch.stopped)):
            if not violations(fleet, plan):
                return front_of(fleet, options, [plan], terminated, watch)
    return search.front(options.size, terminated)


def _tried(fleet: Fleet, watch: Watch[FleetFront]) -> Plan | None:
    """Return a plan of a fleet of few stops, found by trying its routes; None if none is found."""
    if len(fleet.rules.clients) > MOST_STOPS:
        return None
    seconds = max(_TRYING * watch.seconds, watch.spent + _LEAST_TRYING)
    return some_plan(fleet, watch.until(seconds).ended)


def _constructed(
    fleet: Fleet, constructor: Constructor | None, watch: Watch[FleetFront]
) -> list[Plan]:
    """Return the plans made by cutting the tours of a network into routes."""
    if constructor is None:
        raise Refusal("no-actor", kind="fleets with time_limit 0")
    cutter = Cutter(fleet, network_sequences(fleet, constructor), watch.stopped)
    plans = [plan for plan in cutter.plans() if not violations(fleet, plan)]
    if plans:
        return plans
    if watch.stopped():
        raise Cancelled
    reason = "no cut of the network's tours keeps every rule: a time_limit over 0 may find a plan"
    raise Refusal("no-plan", reason=reason)


class _Search:
    """The search for a front: a sweep of searches by PyVRP, all into one archive.

    Costs are rounded up to whole numbers, so a plan that just keeps every rule may seem to break
    one. If nothing is found in half of the time, a second search has bounds that are `loose` by the
    rounding, and each of its solutions is checked.
    """

    def __init__(
        self,
        fleet: Fleet,
        options: FleetOptions,
        watch: Watch[FleetFront],
        loose: bool = False,
    ) -> None:
        self._fleet = fleet
        self._options = options
        self._watch = watch
        units = Units.of(fleet)
        self._reference_point = units.points(reference_point_of(fleet, options))
        self._translation = Translation(units.fleet, loose)
        give_up = not loose and fleet.rules.has_bounds
        self._gives_up = watch.seconds / 2 if give_up else inf
        self.archive = SolutionArchive(self._translation)
        driven = options.driven
        self._kept = None if driven is None else KeptPlans(self._translation, driven)
        self._iterations = 0
        self._checked = 0.0
        self._worked = 0  # stops looked at
        self._pause = 0.0  # the longest recent seconds between two checks of the time
        self._cancelled = False
        self._optional = any(visit.prize is not None for visit in fleet.rules.visits)

    @property
    def _is_short(self) -> bool:
        """Whether the time is over before PyVRP has its first solution."""
        return self._watch.left < _FIRST * self._fleet.rules.n**2

    def begin_plainly(self) -> None:
        """Put a simple plan into an empty archive, if one breaks no rule and time is short."""
        if self.archive or not self._is_short:
            return
        for plan in plain_plans(self._fleet, self._watch.stopped):
            if not violations(self._fleet, plan):
                self._offer(self._translation.solution(plan), FREE)
                return

    def begin_with(self, driven: Plan) -> None:
        """Put a plan into the archive, with the stops that it leaves out where they cost least.

        Stops that fit nowhere stay out; then the plan may break a rule, and is not put there.
        """
        plan = _completed(self._fleet, driven)
        if plan is not None:
            self._offer(self._translation.solution(plan), FREE)

    def _offer(self, solution: pyvrp.Solution, goal: Goal) -> None:
        self.archive.offer(solution, goal)
        if self._kept is not None:
            self._kept.offer(solution)

    def run(self) -> Termination:
        """Search until nothing is left to do, the time is over, or `stop` returns True."""
        options, archive = self._options, self.archive
        solver = Solver(self._translation, options.seed, self._offer, self._ended, self._watch)
        random = np.random.default_rng(options.seed)
        mover: Mover | None = None
        sweep = _sweep_of(self._fleet.rules)
        if archive and self._is_short:
            return "time_limit"
        for step in sweep(self._translation, archive, random, self._left).steps():
            if self._iterations >= options.iterations or self._ended():
                return "cancelled" if self._cancelled else "time_limit"
            iterations = min(step.iterations, options.iterations - self._iterations)
            self._iterations += solver.search(replace(step, iterations=iterations))
            if step.moves is not None:
                mover = mover or Mover(self._translation, archive, random)
                mover.improve(step.moves, self._ended)
        return "converged"

    def front(self, size: int, terminated: Termination | None) -> FleetFront:
        """Return the best front found so far, of at most `size` plans.

        Raises:
            Refusal: No plan was found.
            Cancelled: No plan was found before `stop` returned True.
        """
        archive = self.archive
        points = np.array(archive.points).reshape(-1, len(self._reference_point))
        indices, known = FrontPoints.among(points, self._reference_point)
        seconds = selection_limit(self._options.time_limit)
        chosen = indices[best_subset(known, size, seconds)]
        found = [self._translation.plan(archive.solutions[index]) for index in chosen]
        plans = [plan for plan in found if not violations(self._fleet, plan)]
        if not plans and self._cancelled:
            raise Cancelled
        if not plans:
            sentence = f"no plan was found in {self._options.time_limit:g} s that keeps every rule"
            raise no_plan(self._fleet, sentence, self._watch.lasting(_BRIEF).ended)
        front = front_of(self._fleet, self._options, plans, terminated, self._watch)
        return self._with_kept(replace(front, found=max(front.found, len(archive))))

    def _with_kept(self, front: FleetFront) -> FleetFront:
        """Return the front with a plan that keeps most of the driven plan, if such a plan is short.

        If the front is full, this plan takes the place of the plan nearest to it.
        """
        if self._kept is None or any(map(self._kept.keeps, front.plans)):
            return front
        plan = self._kept.nearest(np.array(self.archive.points))
        if plan is None:
            return front
        point, plans, points = points_of(self._fleet, [plan]), list(front.plans), front.points
        if len(plans) == self._options.size:
            place = int((np.abs(points - point) / front.scale).sum(axis=1).argmin())
            del plans[place]
            points = np.delete(points, place, axis=0)
        place = int(np.searchsorted(points[:, 0], point[0, 0]))
        plans.insert(place, plan)
        return replace(front, plans=plans, points=np.insert(points, place, point, axis=0))

    def _left(self) -> float:
        """Return the number of iterations left, estimated from the time of earlier ones."""
        most = self._options.iterations - self._iterations
        if self._watch.seconds == inf or not self._iterations:
            return most
        return min(most, self._watch.left * self._iterations / self._watch.spent)

    def _ended(self) -> bool:
        """Return whether to stop, after a report if one is due."""
        watch, now = self._watch, self._watch.spent
        self._pause = max(now - self._checked, _FORGOTTEN * self._pause)
        self._checked = now
        self._worked += self._fleet.rules.n
        if watch.stopped():
            self._cancelled = True
            return True
        begun = len(self.archive) >= _LEAST_PLANS or self._worked >= _LEAST_WORK
        begun |= len(self.archive) > 0 and watch.over(-_GRACE)
        if now > self._gives_up and begun and not self.archive:
            return True
        watch.report_if_due(self._found, partial(self.front, terminated=None))
        return begun and watch.over(self._reserve())

    def _found(self) -> tuple[float, int] | None:
        """Return the hypervolume and the number of plans found so far; None if there is none."""
        if not self.archive:
            return None
        found = FrontPoints(np.array(self.archive.points), self._reference_point)
        return found.quick_hypervolume, len(found)

    def _reserve(self) -> float:
        """Return the seconds for one more iteration, and for checking and selecting plans after it.

        The iteration is assumed to be as long as the longest recent one.
        """
        found, explained = len(self.archive), 0.0
        if self._optional:
            missing = (each.num_missing_clients() for each in self.archive.solutions)
            explained = _EXPLAINING * min(missing, default=0) * self._fleet.rules.n
            explained = min(explained, _MOST_EXPLAINING * self._options.time_limit)
        checked = _CHECKING * min(found, self._options.size) * self._fleet.rules.n
        limit = selection_limit(self._options.time_limit)
        selected = selection_seconds(self._options.size, found, len(self._reference_point), limit)
        return self._pause + checked + explained + selected


def _sweep_of(rules: Rules) -> type[Searches]:
    """Return the searches for the objectives of a fleet."""
    second, *more = rules.over[1:]
    if more or second in ("imbalance", "load_distance"):
        return MixedSweep
    return SumSweep if second in ("sum", "max", "unassigned") else MeasureSweep
