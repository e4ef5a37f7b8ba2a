"""Parts of routes, as far as time goes, and what they are when joined."""

from typing import NamedTuple

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.problem import RELEASED, Problem
from service.fleet.search.working_plan import WorkingPlan, service_at
from service.jit import inlined

_is_over = inlined(is_over)


class Span(NamedTuple):
    """A part of a route: the least time it takes, and the departures that take only this time.

    Attributes:
        time: The least time, with waiting.
        early: The first such departure. Leaving before only adds waiting.
        late: The last departure that keeps all windows.
    """

    time: float
    early: float
    late: float


@inlined
def joined(a: Span, way: float, b: Span) -> tuple[Span, bool]:
    """Return two parts of a route with a leg between them, and whether they keep all windows.

    Vidal et al. (2013), time-window segments.
    """
    until = a.time + way
    waiting = max(0.0, b.early - until - a.late)
    span = Span(
        until + waiting + b.time,
        max(a.early, b.early - until) - waiting,
        min(a.late, b.late - until),
    )
    return span, not _is_over(a.early + until, b.late)


@inlined
def stay(problem: Problem, profile: int, stop: int) -> Span:
    """Return the visit of a stop as a part of a route."""
    service = service_at(problem, profile, stop) + problem.held[stop]
    return Span(service, problem.opens[stop], problem.closes[stop])


@inlined
def head_at(plan: WorkingPlan, node: int) -> Span:
    """Return the route up to a node."""
    return Span(plan.head[node, 0], plan.head[node, 1], plan.head[node, 2])


@inlined
def tail_at(plan: WorkingPlan, node: int) -> Span:
    """Return the route from a node on."""
    return Span(plan.tail[node, 0], plan.tail[node, 1], plan.tail[node, 2])


@inlined
def times_of(problem: Problem, kind: int, span: Span, released: float) -> tuple[float, float]:
    """Return the time that a whole route takes, and when it ends.

    Args:
        problem: The fleet.
        kind: The type of the vehicle.
        span: The route.
        released: When all of its stops are ready to be loaded.

    Returns:
        The time, infinite where the vehicle would have to leave too late, and the end.
    """
    departs = max(span.early, released)
    end = departs + span.time
    if _is_over(departs, span.late, end):
        return np.inf, 0.0
    if problem.early:
        return end - max(problem.departs[kind], released), end
    return span.time, end


@inlined
def times_with(
    problem: Problem,
    plan: WorkingPlan,
    where: tuple[int, int, int],
    begun: Span,
    legs: tuple[float, float],
) -> tuple[float, float]:
    """Return the time that a route takes with one more stop, and when it ends.

    Args:
        problem: The fleet.
        plan: Where the route is changed.
        where: The route, the stop, and the node behind it.
        begun: The route up to the stop.
        legs: How long the legs to the stop, and from it, take.

    Returns:
        The time, infinite where a window is missed, and the end.
    """
    slot, stop, after = where
    span, kept = joined(begun, legs[0], stay(problem, problem.profile[slot], stop))
    if not kept:
        return np.inf, 0.0
    span, kept = joined(span, legs[1], tail_at(plan, after))
    if not kept:
        return np.inf, 0.0
    released = plan.value[slot, RELEASED]
    if not problem.reloads:
        released = max(released, problem.release[stop])
    return times_of(problem, problem.kind[slot], span, released)
