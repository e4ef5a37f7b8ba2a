"""Work out when the visits of a route begin, where an objective depends on it."""

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.problem import ARRIVAL, EARLINESS, Problem
from service.fleet.search.working_plan import WorkingPlan, leg, service_at
from service.jit import compiled, inlined

_is_over = inlined(is_over)


@inlined
def begin_at(problem: Problem, stop: int, arrival: float) -> float:
    """Return when a visit begins, in the first window that is not over; infinite after all."""
    for number in range(problem.windows.shape[1]):
        if not _is_over(arrival, problem.windows[stop, number, 1]):
            return max(arrival, problem.windows[stop, number, 0])
    return np.inf


@compiled
def weigh_begins(problem: Problem, plan: WorkingPlan, start: int, departure: float) -> None:
    """Write the earliness and the weighted arrivals of a route whose departure is known."""
    slot = (start - len(problem.demand)) // 2
    early, arrival, profile = 0.0, 0.0, problem.profile[slot]
    at, node, time, end = problem.place[start], plan.next[start], departure, start + 1
    while node != end:
        step = plan.step[node, problem.clock]
        if plan.via[node] >= 0:
            away = leg(problem, profile, at, plan.via[node], problem.clock)
            time, step = max(time + away, plan.released[node]), step - away
        begin = begin_at(problem, node, time + step)
        if _is_over(problem.wanted[node], begin):
            early += problem.wanted[node] - begin
        arrival += problem.urgency[node] * (begin - problem.begin)
        time = begin + service_at(problem, profile, node)
        at, node = node, plan.next[node]
    plan.value[slot, EARLINESS], plan.value[slot, ARRIVAL] = early, arrival


@inlined
def weighed_with(
    problem: Problem, plan: WorkingPlan, slot: int, stop: int, before: int
) -> tuple[float, float]:
    """Return about what earliness and weighted arrivals are with a stop after a node."""
    if not problem.timely:
        return 0.0, 0.0
    early, arrival = _begins_changed(problem, plan, slot, stop, before)
    return plan.value[slot, EARLINESS] + early, plan.value[slot, ARRIVAL] + arrival


@compiled
def _begins_changed(
    problem: Problem, plan: WorkingPlan, slot: int, stop: int, before: int
) -> tuple[float, float]:
    """Return what earliness and weighted arrivals grow by with a stop after a node, about."""
    end = len(problem.demand) + 2 * slot + 1
    early, arrival, profile = 0.0, 0.0, problem.profile[slot]
    ready, here, node = plan.ready[before], before, stop
    for _ in range(plan.size[slot] + 1):
        step = leg(problem, profile, problem.place[here], node, problem.clock)
        begin = begin_at(problem, node, ready + step)
        if begin == np.inf:
            break
        service = service_at(problem, profile, node)
        ready = begin + service
        early += max(0.0, problem.wanted[node] - begin)
        if node == stop:
            arrival += problem.urgency[node] * (begin - problem.begin)
        else:
            known = plan.ready[node] - service
            early -= max(0.0, problem.wanted[node] - known)
            arrival += problem.urgency[node] * (begin - known)
            if ready <= plan.ready[node]:
                break
        here, node = node, plan.next[before] if node == stop else plan.next[node]
        if node == end:
            break
    return early, arrival
