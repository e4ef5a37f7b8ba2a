"""Parts of PA-One's ONNX graph that build tours by shortlists and then contract what is left."""

import torch
from torch import Tensor, nn

from export.onnx_parts import Part
from export.pa_one_graph import ROW_LISTS, Names
from export.repairs import as_problem, as_tensors, left_of, nearly_solved, present
from models.data.preferences import turned_outwards, weights
from models.networks.joining.candidates import cheaper_starts
from models.networks.joining.contraction import contracted, expanded
from models.networks.joining.costs import Costs, Problem
from models.networks.joining.fragments import Fragments, all_alone, cleared, first_steps
from models.networks.joining.repairs import last_two_joined
from models.networks.joining.shortlists import (
    RowLists,
    Shortlists,
    first_of,
    listed_candidates,
    lists_of_rows,
)
from models.networks.pa_one_matrix import OneMatrixActor, are_listed
from models.rollout_repairs import least_costs


class _Prepare(nn.Module):
    """The costs in each objective, the weights of each preference, its prices, and shortlists."""

    def __init__(self, actor: OneMatrixActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, instance: Tensor, preferences: Tensor) -> tuple[Tensor, ...]:
        rows = weights(turned_outwards(preferences))
        problem, lists = self.actor.listed_problem(instance, rows)
        return *as_tensors(problem), *lists


class _Begin(nn.Module):
    """The lists of the rows, the least cost of each city, and the fragments after one round."""

    def __init__(self, actor: OneMatrixActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, given: tuple[Tensor, ...], lists: tuple[Tensor, ...]) -> tuple[Tensor, ...]:
        problem = as_problem(given)
        of_rows = lists_of_rows(Shortlists(*lists), problem.weights)
        before, candidates = all_alone(of_rows.means[..., 0], leaning=True), first_of(of_rows)
        after = self.actor.round(problem, before, candidates, self.actor.joinings)
        return *of_rows, least_costs(candidates), *_listed(before, after)


class _Round(nn.Module):
    """The fragments after one more round."""

    def __init__(self, actor: OneMatrixActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(
        self, given: tuple[Tensor, ...], lists: tuple[Tensor, ...], fragments: tuple[Tensor, ...]
    ) -> tuple[Tensor, ...]:
        problem, before = as_problem(given), Fragments(*fragments)
        candidates = listed_candidates(RowLists(*lists), before)
        after = self.actor.round(problem, before, candidates, self.actor.joinings)
        return _listed(before, after)


class _Contract(nn.Module):
    """The costs between the ends that are left, and the fragments with ends for cities."""

    def forward(
        self, given: tuple[Tensor, ...], fragments: tuple[Tensor, ...]
    ) -> tuple[Tensor, ...]:
        between, few = contracted(as_problem(given), Fragments(*fragments))
        return *present(between), *left_of(few)


class _Finish(nn.Module):
    """The links of the tours, and the first two cities of each."""

    def forward(
        self,
        given: tuple[Tensor, ...],
        fragments: tuple[Tensor, ...],
        between: tuple[Tensor, ...],
        solved: tuple[Tensor, ...],
    ) -> tuple[Tensor, ...]:
        whole = last_two_joined(Costs(*between), Fragments(*solved))
        tours = expanded(Fragments(*fragments), whole)
        return tours.links, *first_steps(tours, cheaper_starts(as_problem(given), tours))


def _listed(before: Fragments, after: Fragments) -> tuple[Tensor, ...]:
    """Return the cleared fragments, how many ends to keep, and whether lists go on being used."""
    moved, kept = cleared(after)
    return *present(moved), kept[None], are_listed(before, after)


def parts(
    actor: OneMatrixActor,
    names: Names,
    given: tuple[Tensor, Tensor],
    state: tuple[Problem, Fragments, Fragments],
) -> dict[str, Part]:
    """Return the parts that build tours, by name.

    The state is a problem with fragments that have some ends, and others that have more.
    """
    problem, some, more = state
    with torch.no_grad():
        _, lists = actor.listed_problem(given[0], problem.weights)
        row_lists = lists_of_rows(lists, problem.weights)
        between, few = contracted(problem, more)
    solved = nearly_solved(actor, between, few, some.ends.shape[1])
    tensors, in_rows = as_tensors(problem), [f"row_{name}" for name in ROW_LISTS]
    fragments, after = list(names.fragments), names.after_round
    return {
        "Prepare": (
            _Prepare(actor),
            given,
            [names.instance, "preferences"],
            [*names.problem, *names.lists],
        ),
        "Begin": (
            _Begin(actor),
            (tensors, tuple(lists)),
            [*names.problem, *names.lists],
            [*in_rows, "least", *after],
        ),
        "Round": (
            _Round(actor),
            (tensors, tuple(row_lists), present(some)),
            [*names.problem, *in_rows, *fragments],
            after,
        ),
        "Contract": (
            _Contract(),
            (tensors, present(more)),
            [*names.problem, *fragments],
            [*names.costs, *after],
        ),
        "Finish": (
            _Finish(),
            (tensors, present(more), present(between), present(solved)),
            [
                *(*names.problem, *fragments, *names.costs),
                *(f"solved_{name}" for name in fragments),
            ],
            ["tour_links", "first", "second"],
        ),
    }
