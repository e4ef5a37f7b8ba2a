"""replan(...): the front of the rest of the way, from the tours of an earlier front."""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from service.construction.first_tours import Constructor
from service.errors import Refusal
from service.front import Front, PlanOptions, ReportOf, reporting
from service.instance import Instance, tour_lengths
from service.pareto import nondominated
from service.planner import plan
from service.replanning.earlier_tours import EarlierTours, Tours, few_enough, touched_cities
from service.replanning.insertion import completed
from service.replanning.kept_legs import kept_shares, most_like_driven, with_most_kept_at
from service.search.best_subset import best_subset

_LEAST_SECONDS = 1e-3  # that are left for the search when the earlier tours took all of its time
_ROUNDING = 1e-9  # of a share
_MOST_CELLS = 2**22  # of all tours among which those that keep enough are looked for


def replan(
    constructor: Constructor,
    instance: Instance,
    options: PlanOptions,
    earlier: EarlierTours,
    stop: Callable[[], bool] = lambda: False,
    report: ReportOf[Front] = lambda *_: None,
) -> Front:
    """Return the best front found for an instance whose cities were in an earlier front, mostly.

    The search sets out from the earlier tours. Where it has time, the network builds tours only if
    preferences are asked for: from tours that are nearly right the search gains nothing by more.
    Of tours of equal lengths an earlier one that keeps more of the driven tour's legs is returned,
    and at the driven tour's balance, of tours about as near to it and as short, the one that keeps
    most.

    Args:
        constructor: Builds further tours.
        instance: The rest of the way.
        options: What front is wanted, and how much may be spent on it.
        earlier: What is left of the tours of the earlier front.
        stop: As of plan(...).
        report: As of plan(...).

    Raises:
        Cancelled: As of plan(...).
        Refusal: No tour found keeps as much of the driven tour as it shall.
    """
    began = time.perf_counter()
    first = _first_tours(instance, earlier)
    wanted = _as_remembered(options, instance, earlier, first) if len(first) else options
    spent = time.perf_counter() - began
    if wanted.time_limit > 0:
        wanted = replace(wanted, time_limit=max(_LEAST_SECONDS, wanted.time_limit - spent))
    if earlier.min_kept > 0:
        wanted = replace(wanted, size=max(options.size, _MOST_CELLS // instance.n))
    elif earlier.balance is not None:
        choose = partial(with_most_kept_at, instance, earlier.driven, earlier.balance)
        wanted = replace(wanted, choose_again=choose)

    def with_kept(front: Front) -> Front:
        return replace(front, kept=kept_shares(instance, front.tours, earlier.driven))

    wanted = replace(wanted, initial_tours=first)
    front = plan(constructor, instance, wanted, stop, reporting(report, with_kept))
    timings = {**front.timings, "construction": front.timings["construction"] + 1000 * spent}
    front = replace(front, timings=timings)
    if earlier.min_kept > 0:
        front = _keeping(instance, front, first, earlier, options.size)
    elif len(first):
        tours = most_like_driven(instance, front.tours, front.points, first, earlier.driven)
        front = replace(front, tours=tours)
    return with_kept(front)


def _first_tours(instance: Instance, earlier: EarlierTours) -> Tours:
    """Return the earlier tours, complete, those first that keep most of the driven one."""
    if earlier.tours.shape[1] == 0:
        return np.empty((0, instance.n), np.int64)
    tours = completed(instance, few_enough(instance, earlier))
    kept = kept_shares(instance, tours, earlier.driven)
    return tours[np.argsort(-kept, kind="stable")]


def _as_remembered(
    options: PlanOptions, instance: Instance, earlier: EarlierTours, first: Tours
) -> PlanOptions:
    """Return the options of a plan that sets out from the earlier tours, and not from others."""
    if options.fewer and options.time_limit > 0:
        options = replace(options, angles=np.empty(0))
    return replace(options, touched=touched_cities(instance, earlier, first))


def _keeping(
    instance: Instance, front: Front, first: Tours, earlier: EarlierTours, size: int
) -> Front:
    """Return the best of a front and the first tours that keep enough of the driven tour."""
    allowed = np.isfinite(tour_lengths(instance, first)).all(axis=1)
    tours = np.concatenate((first[allowed], front.tours))
    kept = kept_shares(instance, tours, earlier.driven)
    enough = kept >= earlier.min_kept - _ROUNDING
    if not enough.any():
        most = float(kept.max())
        pointer = "/min_kept"
        raise Refusal("too-different", pointer=pointer, limit=earlier.min_kept, actual=most)
    tours = tours[enough]
    tours = tours[nondominated(tour_lengths(instance, tours))]
    chosen = best_subset(tour_lengths(instance, tours), size, front.reference_point)
    points = tour_lengths(instance, tours[chosen])
    return replace(front, tours=tours[chosen], points=points, found=len(tours))
