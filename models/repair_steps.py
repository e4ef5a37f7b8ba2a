"""Training steps on repairs: policy gradient on the gain of joining a cut tour again.

The states are those of real repairs: tours as the actor builds them, then after one of its own
repairs, after two, and so on. Now and then the actor also learns from building tours, so that it
does not forget how.
"""

from collections.abc import Sequence
from typing import NamedTuple, cast

import torch
from jaxtyping import Float, Int
from torch import Tensor

from models.checkpoint import Run
from models.networks.joining.costs import Problem
from models.networks.joining.fragments import Fragments
from models.networks.joining.repairs import (
    ENOUGH,
    Cuts,
    cut,
    laid_out,
    last_two_joined,
    repair_problem,
)
from models.networks.pa_one import OneActor, rows_of
from models.networks.rows import repeated, split, stacked
from models.rollout_pa_one import joined_by_chance
from models.rollout_repairs import (
    RepairState,
    cheaper_way,
    cities_to_cut,
    least_costs,
    sizes_of_cut,
    state_after_repair,
    unrepaired,
)
from models.steps import StepMeans, drawn_instances, drawn_preferences, learn_to_build, update

_REPAIRS = 60  # of each tour, one after another
_BUILT_EVERY = 8  # repairs
_LEAK = 0.25  # how much a longer tour counts, if one that is as much shorter counts 1


class _Chain(NamedTuple):
    """The tours of one instance on their way through the repairs."""

    problem: Problem
    least: Float[Tensor, "r n"]
    state: RepairState


def repair_step(run: Run) -> StepMeans:
    """Draw instances, build their tours, and descend after each of many repairs."""
    actor = cast(OneActor, run.actor)
    preferences = rows_of(drawn_preferences(run))
    chains = [_begun(actor, instance, preferences) for instance in drawn_instances(run)]
    losses = []
    for number in torch.arange(_REPAIRS):
        if number % _BUILT_EVERY == 0:
            learn_to_build(run)
        chains, loss = _learned(run, chains, number)
        losses.append(loss)
    run.step += 1
    lengths = torch.cat([_weighted(chain, chain.state.points) for chain in chains])
    mean_loss = sum(losses) / len(losses)
    return StepMeans(mean_loss, objective=lengths.mean().item(), violation=0.0, multiplier=0.0)


@torch.no_grad()
def _begun(actor: OneActor, instance: Tensor, rows: Float[Tensor, "r m"]) -> _Chain:
    problem = actor.problem(instance, rows)
    least = least_costs(actor.first_candidates(problem))
    return _Chain(problem, least, unrepaired(problem.costs, actor.built(problem)))


def _learned(
    run: Run, chains: Sequence[_Chain], number: Int[Tensor, ""]
) -> tuple[list[_Chain], float]:
    """Descend by repairs drawn for each tour; return the chains after the greedy repair."""
    actor, times = cast(OneActor, run.actor), run.config.starts
    sizes = sizes_of_cut(chains[0].least.shape[1], int(number))
    with torch.no_grad():
        cities = [
            cities_to_cut(problem, least, (state.tours, state.freshness), number, sizes)
            for problem, least, state in chains
        ]
        cuts = [cut(chain.state.tours, each) for chain, each in zip(chains, cities, strict=True)]
        problems = [
            repair_problem(chain.problem, each) for chain, each in zip(chains, cuts, strict=True)
        ]
        costs = stacked([between for between, _ in problems])
        fragments = stacked([left for _, left in problems])
    costs_of_drawn = repeated(costs, times)
    drawn, likelihoods = joined_by_chance(
        actor.judgement(actor.repair_joinings),
        costs_of_drawn,
        repeated(fragments, times),
        run.sampling_generator,
        enough=ENOUGH,
    )
    with torch.no_grad():
        drawn_by_chain = split(last_two_joined(costs_of_drawn, drawn), len(chains))
        advantages = [
            _advantages(chain, repeated(each, times), whole)
            for chain, each, whole in zip(chains, cuts, drawn_by_chain, strict=True)
        ]
    loss = (torch.cat(advantages) * likelihoods).mean()
    update(run, loss)
    with torch.no_grad():
        best = split(actor.rejoined(costs, fragments), len(chains))
        tours = map(laid_out, cuts, best)
        after = [_after(*each) for each in zip(chains, cities, tours, strict=True)]
    return after, loss.item()


def _advantages(chain: _Chain, cuts: Cuts, whole: Fragments) -> Float[Tensor, " rt"]:
    """Return how much worse each tour is than the mean of those that were drawn with it."""
    r, n = chain.state.tours.shape
    before = _weighted(chain, chain.state.points)[:, None]
    tours = laid_out(cuts, whole)
    rows = chain.problem.weights.repeat_interleave(len(tours) // r, dim=0)
    points = cheaper_way(chain.problem.costs, rows, tours)[1]
    lengths = (points * rows).sum(dim=1).view(r, -1)
    longer = n * (lengths / before - 1)  # in edges of the mean length
    objectives = torch.where(longer < 0, longer, _LEAK * longer)
    return (objectives - objectives.mean(dim=1, keepdim=True)).flatten()


def _after(chain: _Chain, cities: Int[Tensor, "r m"], tours: Int[Tensor, "r n"]) -> _Chain:
    problem = chain.problem
    state = state_after_repair(problem.costs, problem.weights, chain.state, cities, tours)
    return chain._replace(state=state)


def _weighted(chain: _Chain, points: Float[Tensor, "r m"]) -> Float[Tensor, " r"]:
    return (points * chain.problem.weights).sum(dim=1)
