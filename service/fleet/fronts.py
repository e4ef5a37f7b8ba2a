"""The options of the front of a fleet, and the front of some plans."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.fleet.evaluation import points_of
from service.fleet.fleet import Array, Fleet
from service.fleet.plans import FleetFront, Plan
from service.fleet.reference_point import default_reference_point
from service.front import Termination
from service.search.best_subset import best_subset
from service.search.front_points import FrontPoints
from service.watch import Watch

_NO_LIMIT = 2**62


@dataclass(frozen=True, kw_only=True, eq=False)
class FleetOptions:
    """The options of plan_fleet(...).

    Args:
        time_limit: The most seconds for everything, or some 0.1 s more where no plan is found by
            then. At 0 there is no search: plans are made by cutting the tours of the
            network into routes.
        size: The greatest number of plans of the front.
        seed: The seed of all random choices.
        reference_point: The reference point of the hypervolume under m objectives, shape (m,); by
            default lengths that no sensible plan reaches.
        iterations: The most rounds of a hundred ruins. With an infinite time limit, the same seed
            and iterations give the same front.
        driven: A plan to start from, which may leave out stops.
    """

    time_limit: float
    size: int = 100
    seed: int = 0
    reference_point: Array | None = None
    iterations: int = _NO_LIMIT
    driven: Plan | None = None


def front_of(
    fleet: Fleet,
    options: FleetOptions,
    plans: Sequence[Plan],
    terminated: Termination | None,
    watch: Watch[FleetFront],
    constructed: int = 0,
) -> FleetFront:
    """Return the front of plans that break no rule."""
    points = points_of(fleet, plans)
    reference_point = reference_point_of(fleet, options)
    indices, front = FrontPoints.among(points, reference_point)
    chosen = best_subset(front, options.size)
    best, kept = front.at(chosen), indices[chosen]
    return FleetFront(
        fleet=fleet,
        plans=[plans[index] for index in kept],
        points=best.points,
        found=len(front),
        constructed=constructed,
        scale=fleet.scale,
        reference_point=reference_point,
        hypervolume=best.hypervolume,
        terminated=terminated,
        timings={"improvement": 1000 * watch.spent},
    )


def reference_point_of(fleet: Fleet, options: FleetOptions) -> Array:
    """Return the reference point of the options, or the default of the fleet."""
    given = options.reference_point
    return default_reference_point(fleet) if given is None else given
