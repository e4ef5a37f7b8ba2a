"""Keep the plans that the search found: the nondominated ones, and those near a driven plan."""

from typing import NamedTuple

from service.fleet.search.problem import Array, Nodes, Problem
from service.fleet.search.rows import write_row
from service.fleet.search.working_plan import WorkingPlan
from service.jit import compiled
from service.search.archive.insertion import accepts, insert
from service.search.archive.layout import Archive


class Driven(NamedTuple):
    """A plan that is driven, by stop: its vehicle's type, and the stop before it, -1 for none.

    Where the vehicle loads again before a stop, that is at the place where it loads. A plan that
    keeps most of it keeps at least `most` of these steps; -1 for no plan.
    """

    kind: Nodes  # (n,); -1 if it is not visited
    before: Nodes  # (n,)
    most: int


class Found(NamedTuple):
    """The nondominated plans, and those among the plans that keep most of the driven one."""

    plans: Archive
    kept: Archive
    driven: Driven
    point: Array  # (m,), scratch space
    row: Nodes  # scratch space


@compiled
def offer(problem: Problem, plan: WorkingPlan, found: Found) -> None:
    """Offer a plan that visits all required stops, with its point, to the archives."""
    if accepts(found.plans, found.point):
        write_row(problem, plan, found.row)
        insert(found.plans, found.point, found.row)
    if (
        found.driven.most >= 0
        and accepts(found.kept, found.point)
        and _kept_steps(problem, plan, found.driven) >= found.driven.most
    ):
        write_row(problem, plan, found.row)
        insert(found.kept, found.point, found.row)


@compiled
def _kept_steps(problem: Problem, plan: WorkingPlan, driven: Driven) -> int:
    """Return how many steps of a driven plan are in a plan."""
    kept, n = 0, len(problem.demand)
    for number in range(len(problem.clients)):
        stop = problem.clients[number]
        slot = plan.route[stop]
        if slot >= 0 and driven.kind[stop] == problem.kind[slot]:
            before = plan.previous[stop] if plan.via[stop] < 0 else plan.via[stop]
            kept += (before if before < n else -1) == driven.before[stop]
    return kept
