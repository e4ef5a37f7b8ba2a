"""replan(...): plan the front of the rest of the way from the tours of an earlier front."""

from dataclasses import replace
from functools import partial

import numpy as np

from service.construction.first_tours import Constructor
from service.errors import Refusal
from service.front import Front, PlanOptions
from service.instance import Instance, tour_lengths
from service.objectives import MOST_OBJECTIVES
from service.planner import plan
from service.replanning.earlier_tours import EarlierTours, Tours, few_enough, touched_cities
from service.replanning.insertion import completed
from service.replanning.kept_legs import kept_shares, most_like_driven, with_most_kept_at
from service.search.best_subset import best_subset, selection_limit
from service.search.front_points import FrontPoints
from service.watch import Watch

_LEAST_SECONDS = 1e-3  # for the search, even if completing the earlier tours took all of the time
_ROUNDING = 1e-9  # of a share
# Of the tours among which those that keep enough legs are chosen: cities of all of them for each
# second that choosing may take, and tours under four objectives.
_CITIES_A_SECOND, _MOST_UNDER_FOUR = 10_000_000, 4_000


def replan(
    constructor: Constructor,
    instance: Instance,
    earlier: EarlierTours,
    options: PlanOptions,
    watch: Watch[Front] | None = None,
) -> Front:
    """Return the best front found for an instance most of whose cities were in an earlier front.

    The search starts from the earlier tours. With a time limit the network builds tours only if
    preferences are asked for: the search gains nothing from them if its tours are nearly right.
    Among tours of equal lengths, an earlier one that keeps more of the driven tour's legs is
    returned. At the driven tour's balance, the tour that keeps most legs is returned among those
    that are about as near to the balance and about as short.

    Args:
        instance: The rest of the way.
        earlier: The rest of the tours of the earlier front.
        options: The options of the front and the search.
        watch: The watch over the work, as in plan(...).

    Raises:
        Cancelled, NoTour: As in plan(...).
        Refusal: No tour was found that keeps `min_kept` of the driven tour.
    """
    watch = (watch or Watch()).lasting(options.time_limit)
    first = _first_tours(instance, earlier)
    wanted = replace(_from_earlier(options, instance, earlier, first), initial_tours=first)
    spent = watch.spent
    if wanted.time_limit > 0:
        wanted = replace(wanted, time_limit=max(_LEAST_SECONDS, wanted.time_limit - spent))

    def with_kept(front: Front) -> Front:
        return replace(front, kept=kept_shares(instance, front.tours, earlier.driven))

    front = plan(constructor, instance, wanted, watch.converting(with_kept))
    timings = {**front.timings, "construction": front.timings["construction"] + 1000 * spent}
    front = replace(front, timings=timings)
    if earlier.min_kept > 0:
        front = _keeping(instance, front, first, earlier, options)
    elif len(first):
        tours = most_like_driven(instance, front.tours, front.points, first, earlier.driven)
        front = replace(front, tours=tours)
    return with_kept(front)


def _first_tours(instance: Instance, earlier: EarlierTours) -> Tours:
    """Return the completed earlier tours; those that keep most of the driven one come first."""
    if earlier.tours.shape[1] == 0:
        return np.empty((0, instance.n), np.int64)
    tours = completed(instance, few_enough(instance, earlier))
    kept = kept_shares(instance, tours, earlier.driven)
    return tours[np.argsort(-kept, kind="stable")]


def _from_earlier(
    options: PlanOptions, instance: Instance, earlier: EarlierTours, first: Tours
) -> PlanOptions:
    """Return the options of a search from the earlier tours."""
    if len(first):
        options = replace(options, touched=touched_cities(instance, earlier, first))
        if options.fewer and options.time_limit > 0:
            options = replace(options, directions=options.directions[:0])
    if earlier.min_kept > 0:
        seconds = selection_limit(options.time_limit)
        most = int(_CITIES_A_SECOND * seconds) // instance.n
        if instance.objectives == MOST_OBJECTIVES:
            most = min(most, _MOST_UNDER_FOUR)
        limit = max(0.0, options.time_limit - seconds)
        return replace(options, size=max(options.size, most), time_limit=limit)
    if earlier.balance is None:
        return options
    choose = partial(with_most_kept_at, instance, earlier.driven, earlier.balance)
    return replace(options, choose_again=choose)


def _keeping(
    instance: Instance, front: Front, first: Tours, earlier: EarlierTours, options: PlanOptions
) -> Front:
    """Return the best of a front and the first tours that keep enough of the driven tour."""
    allowed = np.isfinite(tour_lengths(instance, first)).all(axis=1)
    tours = np.concatenate((first[allowed], front.tours))
    kept = kept_shares(instance, tours, earlier.driven)
    enough = kept >= earlier.min_kept - _ROUNDING
    if not enough.any():
        least, most = earlier.min_kept, float(kept.max())
        raise Refusal("too-different", pointer="/min_kept", limit=least, actual=most)
    tours = tours[enough]
    indices, known = FrontPoints.among(tour_lengths(instance, tours), front.reference_point)
    chosen = best_subset(known, options.size, selection_limit(options.time_limit))
    best = known.at(chosen)
    return replace(
        front,
        tours=tours[indices[chosen]],
        points=best.points,
        hypervolume=best.hypervolume,
        found=len(known),
    )
