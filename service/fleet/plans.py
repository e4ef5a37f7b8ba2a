"""Plans of a fleet: the routes of its vehicles, and fronts of plans."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

from service.fleet.fleet import Array, Fleet
from service.fleet.rules import Rules


@dataclass(frozen=True)
class Route:
    """The visits of one vehicle, in order, without its start and end.

    Args:
        vehicle: The type of the vehicle.
        stops: The stops that it visits.
        bounds: When some of these visits may begin because of those on other routes: the stop, from
            when on, and until when without delaying another. See with_waits().
    """

    vehicle: int
    stops: tuple[int, ...]
    bounds: tuple[tuple[int, float, float], ...] = ()


@dataclass(frozen=True)
class Plan:
    """The routes of all vehicles that are used."""

    routes: tuple[Route, ...]

    def visited(self) -> Iterator[int]:
        """Yield each visited stop, in the order of the routes."""
        return (stop for route in self.routes for stop in route.stops)


def kept_share(driven: Plan, plan: Plan) -> float:
    """Return the share of a driven plan's stops that a plan keeps; 1 if there are none.

    A stop is kept if the same type of vehicles visits it after the same stop, or first as before.
    """
    before, after = set(steps_of(driven)), set(steps_of(plan))
    return len(before & after) / len(before) if before else 1.0


def steps_of(plan: Plan) -> Iterator[tuple[int, int | None, int]]:
    """Yield the vehicle of each stop, the stop before it, and the stop."""
    for route in plan.routes:
        for before, stop in zip((None, *route.stops), route.stops, strict=False):
            yield route.vehicle, before, stop


def path_of(rules: Rules, route: Route) -> tuple[int, ...]:
    """Return the stops of a route, with its start and end if these are stops."""
    vehicle = rules.vehicles[route.vehicle]
    ends = [() if end is None else (end,) for end in (vehicle.start, vehicle.end)]
    return (*ends[0], *route.stops, *ends[1])


@dataclass(frozen=True, eq=False, kw_only=True)
class FleetFront:
    """Nondominated plans and their points, by ascending first length.

    Attributes:
        fleet: The fleet.
        plans: The m plans.
        points: Their lengths under d objectives, shape (m, d).
        found: The number of nondominated plans found; m of these were kept.
        constructed: The number of plans that were cut from the tours of a network.
        scale: The unit of each objective, shape (d,).
        reference_point: The reference point of the hypervolume, shape (d,).
        hypervolume: The hypervolume of the plans kept.
        terminated: How the search ended; None while it runs.
        timings: Milliseconds by phase.
    """

    fleet: Fleet
    plans: Sequence[Plan]
    points: Array
    found: int
    scale: Array
    reference_point: Array
    hypervolume: float
    terminated: Literal["converged", "time_limit", "cancelled"] | None
    timings: dict[str, float] = field(default_factory=dict)
    constructed: int = 0
