"""Say when a search for the front of a fleet ends, and what it answers."""

from abc import ABC, abstractmethod
from dataclasses import replace
from functools import partial

import numpy as np

from service.errors import Cancelled
from service.fleet.conflicts import no_plan
from service.fleet.evaluation import points_of, violations
from service.fleet.fleet import Array, Fleet
from service.fleet.fronts import FleetOptions, front_of, reference_point_of
from service.fleet.plans import FleetFront, Plan, kept_share
from service.fleet.units import Units
from service.front import Termination
from service.search.best_subset import best_subset, selection_limit, selection_seconds
from service.search.front_points import FrontPoints
from service.watch import Watch

BRIEF = 0.25  # seconds to find what is in the way where there is no plan
KEPT = 0.9  # share of the stops of a driven plan that a plan keeps which keeps most of it
_LONGER = 0.05  # by how much each length of such a plan may exceed that of a plan of the front
_FORGOTTEN = 0.9  # decay of the longest pause between two checks of the time, per check
# With fewer plans, and fewer stops looked at (all in each iteration), a search goes on after its
# deadline: a process that is held up else finds no plan.
_LEAST_PLANS, _LEAST_WORK = 10, 2000
_GRACE = 0.03  # seconds after the deadline, at the latest, when it ends all the same
_CHECKING = 1e-5  # seconds for each stop of each plan, twice what a 2.5 GHz Xeon takes
_EXPLAINING = 1e-5  # seconds for each stop that is left out, per stop of the fleet
_MOST_EXPLAINING = 0.05  # share of the time limit for that


class FleetSearch(ABC):
    """A search for the front of a fleet.

    Args:
        fleet: The fleet.
        options: The options of the front and the search.
        watch: Says when to end and to report.
        units: The units in which it searches.
    """

    def __init__(
        self, fleet: Fleet, options: FleetOptions, watch: Watch[FleetFront], units: Units
    ) -> None:
        self._fleet = fleet
        self._options = options
        self._watch = watch
        self._reference_point = units.points(reference_point_of(fleet, options))
        self._checked = 0.0
        self._worked = 0  # stops looked at
        self._pause = 0.0  # the longest recent seconds between two checks of the time
        self._cancelled = False

    @property
    @abstractmethod
    def points(self) -> Array:
        """The lengths of all nondominated plans so far, shape (k, m), by ascending first length."""

    @abstractmethod
    def __len__(self) -> int:
        """Return the number of nondominated plans so far."""

    @abstractmethod
    def plan_at(self, index: int) -> Plan:
        """Return the plan of a point."""

    @abstractmethod
    def begin_with(self, plan: Plan) -> None:
        """Start from a plan that keeps every rule."""

    @abstractmethod
    def run(self) -> Termination:
        """Search until nothing is left to do, the time is over, or the watch says to stop."""

    @abstractmethod
    def _fewest_left_out(self) -> int:
        """Return the least number of stops that a plan leaves out."""

    @abstractmethod
    def _kept(self) -> tuple[Array, list[Plan]]:
        """Return the plans that keep most of the driven one, and their points, shape (k, m)."""

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
        return self._with_kept(replace(front, found=max(front.found, len(points))), points)

    def _with_kept(self, front: FleetFront, points: Array) -> FleetFront:
        """Return the front with a plan that keeps most of the driven plan, if such a plan is short.

        If the front is full, this plan takes the place of the plan nearest to it.
        """
        driven = self._options.driven
        if driven is None or any(kept_share(driven, each) >= KEPT for each in front.plans):
            return front
        kept_points, kept_plans = self._kept()
        nearest = _least_longer(kept_points, points)
        if nearest is None:
            return front
        plan = kept_plans[nearest]
        point, plans, points = points_of(self._fleet, [plan]), list(front.plans), front.points
        if len(plans) == self._options.size:
            place = int((np.abs(points - point) / front.scale).sum(axis=1).argmin())
            del plans[place]
            points = np.delete(points, place, axis=0)
        place = int(np.searchsorted(points[:, 0], point[0, 0]))
        plans.insert(place, plan)
        return replace(front, plans=plans, points=np.insert(points, place, point, axis=0))

    def _ended(self) -> bool:
        """Return whether to stop, after a report if one is due."""
        watch, now = self._watch, self._watch.spent
        self._pause = max(now - self._checked, _FORGOTTEN * self._pause)
        self._checked = now
        self._worked += self._fleet.rules.n
        if watch.stopped():
            self._cancelled = True
            return True
        begun = len(self) >= _LEAST_PLANS or self._worked >= _LEAST_WORK
        begun |= len(self) > 0 and watch.over(-_GRACE)
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
        checked = _CHECKING * min(found, self._options.size) * n
        limit = selection_limit(self._options.time_limit)
        selected = selection_seconds(self._options.size, found, len(self._reference_point), limit)
        return self._pause + checked + explained + selected


def _least_longer(kept: Array, points: Array) -> int | None:
    """Return which of the kept plans is the least longer than a front; None if all are much longer.

    Args:
        kept: Their lengths, shape (k, m).
        points: The lengths of the plans of the front, shape (l, m).
    """
    if not len(kept):
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        grown = kept[:, np.newaxis] / points - 1
    # Where a point of the front is 0 and the plan's length too, nothing has grown.
    excess = np.nan_to_num(grown, posinf=np.inf).max(axis=2).min(axis=1)
    best = int(excess.argmin())
    return best if excess[best] <= _LONGER else None
