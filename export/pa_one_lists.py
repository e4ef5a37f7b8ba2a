"""Parts of PA-One's ONNX graph that build tours by shortlists, and then by contraction."""

import torch
from torch import Tensor, nn

from export.onnx_parts import Part
from export.pa_one_names import Names
from export.repairs import Rejoin, as_problem, as_tensors, left_of, nearly_solved, present
from models.data.preferences import weights
from models.networks.joining.candidates import cheaper_starts
from models.networks.joining.closing import joined_to_one
from models.networks.joining.contraction import contracted, expanded
from models.networks.joining.costs import Costs, Matrices, Problem
from models.networks.joining.fragments import Fragments, all_alone, cleared
from models.networks.joining.prices import prices_of
from models.networks.joining.shortlists import RowLists, first_of, own_lists, own_lists_of
from models.networks.joining.walks import (
    Walks,
    begun_at,
    doubled,
    end_out_of_sight,
    walked,
)
from models.networks.pa_one import OneActor
from models.rollout_repairs import least_costs

_WALKS = ["onwards", "steps", "begin", "last"]


class _Prepare(nn.Module):
    """The costs in each objective, and the weights of each preference."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, instance: Tensor, preferences: Tensor) -> tuple[Tensor, ...]:
        return *self.actor.costs(instance), weights(preferences)


class _OwnPrices(nn.Module):
    """The prices of the cities in each row, from its own weights."""

    def forward(self, tables: tuple[Tensor, ...], rows: Tensor) -> tuple[Tensor, ...]:
        return prices_of(Matrices(*tables), rows)


class _OwnLists(nn.Module):
    """The lists of some cities in each row, from its own weights."""

    def forward(
        self, given: tuple[Tensor, ...], some: Tensor, listed: Tensor
    ) -> tuple[Tensor, ...]:
        return present(own_lists_of(some, as_problem(given), listed.shape[0]))


class _Begin(nn.Module):
    """The least cost of each city, and the fragments after one round."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, given: tuple[Tensor, ...], lists: tuple[Tensor, ...]) -> tuple[Tensor, ...]:
        problem, of_rows = as_problem(given), RowLists(*lists)
        before = all_alone(of_rows.means[..., 0], leaning=self.actor.has_directions)
        candidates = first_of(of_rows, self.actor.candidates)
        after = self.actor.round(problem, before, candidates, self.actor.joinings)
        return least_costs(candidates), *_listed(self.actor, before, after)


class _Round(nn.Module):
    """The fragments after one more round of `joinings` joinings."""

    def __init__(self, actor: OneActor, joinings: int) -> None:
        super().__init__()
        self.actor, self.joinings = actor, joinings

    def forward(
        self, given: tuple[Tensor, ...], lists: tuple[Tensor, ...], fragments: tuple[Tensor, ...]
    ) -> tuple[Tensor, ...]:
        problem, before = as_problem(given), Fragments(*fragments)
        candidates = self.actor.candidates_from(RowLists(*lists), before)
        after = self.actor.round(problem, before, candidates, self.joinings)
        return _listed(self.actor, before, after)


class _Contract(nn.Module):
    """The costs between the ends that are left, and the fragments with ends for cities."""

    def forward(
        self, given: tuple[Tensor, ...], fragments: tuple[Tensor, ...]
    ) -> tuple[Tensor, ...]:
        between, few = contracted(as_problem(given), Fragments(*fragments))
        return *present(between), *left_of(few)


class _Finish(nn.Module):
    """The walks along the tours, and whether some end is not seen yet."""

    def forward(
        self,
        given: tuple[Tensor, ...],
        fragments: tuple[Tensor, ...],
        between: tuple[Tensor, ...],
        solved: tuple[Tensor, ...],
    ) -> tuple[Tensor, ...]:
        whole = joined_to_one(Costs(*between), Fragments(*solved))
        tours = expanded(Fragments(*fragments), whole)
        walks = begun_at(tours, cheaper_starts(as_problem(given), tours))
        return *walks, end_out_of_sight(walks)


class _Double(nn.Module):
    """The walks, each departure seeing twice as far, and whether some end is not seen yet."""

    def forward(
        self, onwards: Tensor, steps: Tensor, begin: Tensor, last: Tensor
    ) -> tuple[Tensor, ...]:
        walks = doubled(Walks(onwards, steps, begin, last))
        return walks.onwards, walks.steps, end_out_of_sight(walks)


class _Walk(nn.Module):
    """The tours of walks whose end is seen."""

    def forward(self, onwards: Tensor, steps: Tensor, begin: Tensor, last: Tensor) -> Tensor:
        return walked(Walks(onwards, steps, begin, last))


def _listed(actor: OneActor, before: Fragments, after: Fragments) -> tuple[Tensor, ...]:
    """Return the cleared fragments, how many ends to keep, and whether lists go on being used."""
    moved, kept = cleared(after)
    return *present(moved), kept[None], actor.are_listed(before, after)


def parts(
    actor: OneActor,
    names: Names,
    given: tuple[Tensor, Tensor],
    listed: tuple[Tensor, Tensor],
    state: tuple[Problem, Fragments, Fragments],
) -> dict[str, Part]:
    """Return the parts that build tours, by name.

    Given are an instance and preferences; listed are some cities to make lists of, and as many
    entries as a list has. The state is a problem with fragments that have some ends, and others
    that have more.
    """
    problem, some, more = state
    with torch.no_grad():
        row_lists = own_lists(problem, len(listed[1]))
        between, few = contracted(problem, more)
    solved = nearly_solved(actor, between, few, some.ends.shape[1])
    linked = some._replace(links=some.links.clamp(min=0))  # to any cities
    walks = begun_at(linked, linked.partners[:, :1])
    tensors, in_rows = as_tensors(problem), names.row_lists
    fragments, after = list(names.fragments), names.after_round
    a_round = (
        (tensors, present(row_lists), present(some)),
        [*names.problem, *in_rows, *fragments],
        after,
    )
    own_prices: Part = (
        _OwnPrices(),
        (tuple(problem.costs), problem.weights),
        [*names.tables, "weights"],
        list(names.prices),
    )
    return {
        **({"OwnPrices": own_prices} if names.prices else {}),
        "Prepare": (
            _Prepare(actor),
            given,
            [names.instance, "preferences"],
            [*names.tables, "weights"],
        ),
        "OwnLists": (
            _OwnLists(),
            (tensors, *listed),
            [*names.problem, "some_cities", "on_a_list"],
            list(in_rows),
        ),
        "Begin": (
            _Begin(actor),
            (tensors, present(row_lists)),
            [*names.problem, *in_rows],
            ["least", *after],
        ),
        "Round": (_Round(actor, actor.joinings), *a_round),
        "RoundOfMany": (_Round(actor, actor.joinings_of_many), *a_round),
        "Contract": (
            _Contract(),
            (tensors, present(more)),
            [*names.problem, *fragments],
            [*names.costs, *after],
        ),
        "JoinFew": (
            Rejoin(actor, actor.joinings),
            (present(between), present(solved)),
            [*names.costs, *fragments],
            after,
        ),
        "Finish": (
            _Finish(),
            (tensors, present(more), present(between), present(solved)),
            [
                *(*names.problem, *fragments, *names.costs),
                *(f"solved_{name}" for name in fragments),
            ],
            [*_WALKS, "is_unseen"],
        ),
        "Double": (_Double(), tuple(walks), _WALKS, ["new_onwards", "new_steps", "is_unseen"]),
        "Walk": (_Walk(), tuple(walks), _WALKS, ["tours"]),
    }
