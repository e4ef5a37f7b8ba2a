"""Parts of PA-One's ONNX graph that repair finished tours."""

import torch
from torch import Tensor, nn

from export.onnx_parts import Part
from export.pa_one_names import CUTS, STATE, Names
from models.networks.joining.closing import ENOUGH, joined_to_one
from models.networks.joining.costs import Costs, Matrices, Planes, Prices, Problem
from models.networks.joining.fragments import Fragments, cleared
from models.networks.joining.repairs import Cuts, cut, laid_out, repair_problem
from models.networks.joining.shortlists import RowLists, Shortlists
from models.networks.pa_one import OneActor
from models.rollout_repairs import (
    RepairState,
    as_repaired,
    cities_to_cut,
    state_after_repair,
    unrepaired,
)

_OF_PLANES = 2  # tensors that a problem is given by: cities, and weights


class Unrepaired(nn.Module):
    """The state before the first repair, without the tours themselves."""

    def forward(self, tables: tuple[Tensor, ...], tours: Tensor) -> tuple[Tensor, Tensor]:
        """Return the points of tours and the freshness of their cities."""
        state = unrepaired(as_costs(tables), tours)
        return state.points, state.freshness


class Cut(nn.Module):
    """Cuts of some cities from each tour, and the problem that they leave."""

    def forward(
        self,
        given: tuple[Tensor, ...],
        least: Tensor,
        places: tuple[Tensor, Tensor, Tensor],
        number: Tensor,
        sizes: tuple[Tensor, Tensor],
    ) -> tuple[Tensor, ...]:
        """Return the cities, the cuts, the costs, the fragments, and whether to join them.

        Places are tours, their lengths and the freshness of their cities. There are as many cities
        near, and of them to cut, as the sizes have entries.
        """
        problem = as_problem(given)
        tours, points, freshness = places
        near, count = (size.shape[0] for size in sizes)
        cities = cities_to_cut(problem, least, (tours, freshness), number, (near, count))
        cuts = cut(tours, cities)
        between, fragments = repair_problem(as_repaired(problem, points), cuts)
        return cities, *cuts, *present(between), *left_of(fragments)


class Rejoin(nn.Module):
    """The fragments after one evaluation of the network; two of them at most are to be left."""

    def __init__(self, actor: OneActor, joinings: int) -> None:
        super().__init__()
        self.actor, self.joinings = actor, joinings

    def forward(self, tables: tuple[Tensor, ...], given: tuple[Tensor, ...]) -> tuple[Tensor, ...]:
        """Return the fragments, how many ends to keep, and whether to go on."""
        costs, fragments = Costs(*tables), Fragments(*given)
        return left_of(self.actor.round_of_few(costs, fragments, self.joinings))


class Keep(nn.Module):
    """The state after a repair: the best of all tours for each row."""

    def forward(
        self,
        tables: tuple[Tensor, ...],
        rows: Tensor,
        state: tuple[Tensor, ...],
        cuts: tuple[Tensor, Tensor, Tensor, Tensor],
        between: tuple[Tensor, ...],
        joined: tuple[Tensor, ...],
    ) -> tuple[Tensor, ...]:
        """Return the state after this repair; the cut cities come before the cuts."""
        whole = joined_to_one(Costs(*between), Fragments(*joined))
        tours = laid_out(Cuts(*cuts[1:]), whole)
        return state_after_repair(as_costs(tables), rows, RepairState(*state), cuts[0], tours)


def left_of(fragments: Fragments) -> tuple[Tensor, ...]:
    """Return the cleared fragments, how many ends to keep, and whether too many are left."""
    after, kept = cleared(fragments)
    return *present(after), kept[None], (after.left > ENOUGH).any()


def present(tensors: Costs | Fragments | Shortlists | RowLists) -> tuple[Tensor, ...]:
    """Return the tensors of a kind that are not None."""
    return tuple(tensor for tensor in tensors if tensor is not None)


def as_costs(given: tuple[Tensor, ...]) -> Planes | Matrices:
    """Return these tensors as the costs in each objective."""
    return Planes(*given) if len(given) == 1 else Matrices(*given)


def as_problem(given: tuple[Tensor, ...]) -> Problem:
    """Return these tensors, in the order of `Names.problem`, as a problem."""
    if len(given) == _OF_PLANES:
        cities, rows = given
        return Problem(Planes(cities), rows)
    means, leans, rows, fees, tilts = given
    return Problem(Matrices(means, leans), rows, Prices(fees, tilts))


def as_tensors(problem: Problem) -> tuple[Tensor, ...]:
    """Return the tensors of a problem, in the order of `Names.problem`."""
    return *problem.costs, problem.weights, *(problem.prices or ())


def repair_parts(
    actor: OneActor, names: Names, problem: Problem, cities_cut: tuple[int, int], open_ends: int
) -> dict[str, Part]:
    """Return the parts that repair, by name, to be traced at these sizes.

    `cities_cut` are the cities that a repair looks at, and those of them that it cuts out.
    """
    costs, rows, _ = problem
    tables = tuple(costs)
    r, n = len(rows), costs.n
    tours = torch.arange(n).repeat(r, 1)
    points, freshness = torch.rand(rows.shape), torch.rand(r, n)
    # All different tensors: one that is given twice would be one input.
    state = (tours, points, tours.clone(), points.clone(), freshness)
    sizes = tuple(torch.zeros(count) for count in cities_cut)
    least, cities = torch.rand(r, n), torch.arange(cities_cut[1]).repeat(r, 1)
    cuts = cut(tours, cities)
    between, fragments = repair_problem(problem, cuts)
    joined = nearly_solved(actor, between, fragments, open_ends)
    return {
        "Unrepaired": (
            Unrepaired(),
            (tables, tours),
            [*names.tables, "tours"],
            ["points", "freshness"],
        ),
        "Cut": (
            Cut(),
            (as_tensors(problem), least, (tours, points, freshness), torch.tensor(0), sizes),
            [*names.problem, "least", "tours", "points", "freshness", "number", "near", "count"],
            ["cities", *CUTS, *names.costs, *names.after_round],
        ),
        "Rejoin": (
            Rejoin(actor, actor.last_joinings),
            (present(between), present(joined)),
            [*names.costs, *names.fragments],
            names.after_round,
        ),
        "RejoinFirst": (
            Rejoin(actor, actor.repair_joinings),
            (present(between), present(joined)),
            [*names.costs, *names.fragments],
            names.after_round,
        ),
        "Keep": (
            Keep(),
            (tables, rows, state, (cities, *cuts), present(between), present(joined)),
            [
                *(*names.tables, "weights", *STATE, "cities", *CUTS),
                *(*names.costs, *names.fragments),
            ],
            [f"new_{name}" for name in STATE],
        ),
    }


def nearly_solved(actor: OneActor, costs: Costs, fragments: Fragments, count: int) -> Fragments:
    """Return the fragments when two at most are left in each row, with that many ends."""
    while bool((fragments.left > ENOUGH).any()):
        with torch.no_grad():
            fragments = cleared(actor.round_of_few(costs, fragments, 1))[0]
    return first_ends(fragments, count)


def first_ends(fragments: Fragments, count: int) -> Fragments:
    """Return fragments with that many ends, to trace with, of fragments with more."""
    ends, partners, open_ = (part[:, :count].contiguous() for part in fragments[:3])
    leans = None if fragments.leans is None else fragments.leans[:, :count].contiguous()
    partners = partners.clamp(max=count - 1)
    return Fragments(ends, partners, open_, fragments.links, fragments.left, leans)
