"""Parts of PA-One's ONNX graph that repair finished tours."""

import torch
from torch import Tensor, nn

from export.onnx_parts import Part
from export.pa_one_graph import AFTER_ROUND, CUTS, FRAGMENTS, STATE
from models.networks.candidates import cheapest_candidates
from models.networks.fragments import Fragments, cleared
from models.networks.pa_one import OneActor
from models.networks.repairs import Cuts, cut, laid_out, last_two_joined, repair_problem
from models.rollout_repairs import (
    JOININGS,
    RepairState,
    cities_to_cut,
    state_after_repair,
    unrepaired,
)


class Unrepaired(nn.Module):
    """The state before the first repair, without the tours themselves."""

    def forward(self, distances: Tensor, tours: Tensor) -> tuple[Tensor, Tensor]:
        """Return the points of tours and the freshness of their cities."""
        state = unrepaired(distances, tours)
        return state.points, state.freshness


class Cut(nn.Module):
    """Cuts of some cities from each tour, and the problem that they leave."""

    def forward(
        self,
        distances: Tensor,
        rows: Tensor,
        least: Tensor,
        tours: Tensor,
        freshness: Tensor,
        count: Tensor,
    ) -> tuple[Tensor, ...]:
        """Return the cities, the cuts, the costs, the fragments, and whether to join them.

        There are as many cities as the count has entries.
        """
        cities = cities_to_cut(distances, rows, least, tours, freshness, count.shape[0])
        cuts = cut(tours, cities)
        costs, fragments = repair_problem(distances, rows, cuts)
        return cities, *cuts, costs, *_left(fragments)


class Rejoin(nn.Module):
    """The fragments after one evaluation of the network; two of them at most are to be left."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, costs: Tensor, given: tuple[Tensor, ...]) -> tuple[Tensor, ...]:
        """Return the fragments, how many ends to keep, and whether to go on."""
        fragments = Fragments(*given)
        candidates = cheapest_candidates(costs, fragments)
        return _left(self.actor.round(costs, fragments, candidates, JOININGS))


class Keep(nn.Module):
    """The state after a repair: the shorter one of two tours in each row."""

    def forward(
        self,
        distances: Tensor,
        rows: Tensor,
        state: tuple[Tensor, ...],
        cuts: tuple[Tensor, Tensor, Tensor, Tensor],
        costs: Tensor,
        joined: tuple[Tensor, ...],
    ) -> tuple[Tensor, ...]:
        """Return the state after this repair; the cut cities come before the cuts."""
        tours = laid_out(Cuts(*cuts[1:]), last_two_joined(costs, Fragments(*joined)))
        return state_after_repair(distances, rows, RepairState(*state), cuts[0], tours)


def _left(fragments: Fragments) -> tuple[Tensor, ...]:
    """Return the cleared fragments, how many ends to keep, and whether more are to be joined."""
    after, kept = cleared(fragments)
    return *after, kept[None], (after.left > 2).any()


def repair_parts(
    distances: Tensor, rows: Tensor, cut_cities: int, open_ends: int
) -> dict[str, Part]:
    """Return the parts without weights of the network, by name, to be traced at these sizes."""
    r, n = len(rows), distances.shape[1]
    tours = torch.arange(n).repeat(r, 1)
    points, freshness = torch.rand(r, 2), torch.rand(r, n)
    # All different tensors: one that is given twice would be one input.
    state = (tours, points, tours.clone(), points.clone(), freshness)
    least, cities = torch.rand(r, n), torch.arange(cut_cities).repeat(r, 1)
    cuts = cut(tours, cities)
    costs, fragments = repair_problem(distances, rows, cuts)
    joined = first_ends(fragments, open_ends)
    given = ["distances", "rows"]
    return {
        "Unrepaired": (
            Unrepaired(),
            (distances, tours),
            ["distances", "tours"],
            ["points", "freshness"],
        ),
        "Cut": (
            Cut(),
            (distances, rows, least, tours, freshness, torch.zeros(cut_cities)),
            [*given, "least", "tours", "freshness", "count"],
            ["cities", *CUTS, "costs", *AFTER_ROUND],
        ),
        "Keep": (
            Keep(),
            (distances, rows, state, (cities, *cuts), costs, tuple(joined)),
            [*given, *STATE, "cities", *CUTS, "costs", *FRAGMENTS],
            [f"new_{name}" for name in STATE],
        ),
    }


def first_ends(fragments: Fragments, count: int) -> Fragments:
    """Return fragments with that many ends, to trace with, of fragments with more."""
    ends, partners, open_ = (part[:, :count].contiguous() for part in fragments[:3])
    return Fragments(ends, partners.clamp(max=count - 1), open_, *fragments[3:])
