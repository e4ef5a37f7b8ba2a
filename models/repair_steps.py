"""Training steps on repairs: policy gradient on the gain of joining a cut tour again.

The states are those of real repairs: a front of tours as the actor builds them, then after one of
its own repairs, after two, and so on, in which the rows share their tours. The actor learns from
some of the rows at a time. What it gains is what a new tour is worth to all rows of the front, not
only to the row whose tour it repaired. Now and then the actor also learns from building tours, so
that it does not forget how.
"""

from collections.abc import Sequence
from typing import NamedTuple, cast

import torch
from jaxtyping import Float, Int
from torch import Tensor

from models.checkpoint import Run
from models.data.preferences import random_preferences
from models.networks.joining.closing import ENOUGH, joined_to_one
from models.networks.joining.costs import Problem
from models.networks.joining.fragments import Fragments
from models.networks.joining.repairs import Cuts, cut, laid_out, repair_problem
from models.networks.pa_one import OneActor, rows_of
from models.networks.rows import Rows, changed, repeated, split, stacked
from models.rollout_pa_one import joined_by_chance
from models.rollout_repairs import (
    RepairState,
    as_repaired,
    cheaper_way,
    cities_to_cut,
    least_costs,
    sizes_of_cut,
    state_after_repair,
    unrepaired,
)
from models.shared_tours import gains_for_rows, slopes_for_rows
from models.steps import StepMeans, drawn_instances, learn_to_build, update

_REPAIRS = 60  # of each tour, one after another
_BUILT_EVERY = 8  # repairs
_ROWS_A_DRAW = 4  # of which one is learned from
_LENGTH = 0.25  # how much a shorter tour counts, if as great a gain of a row counts 1


class _Chain(NamedTuple):
    """The tours of one instance on their way through the repairs."""

    problem: Problem
    least: Float[Tensor, "r n"]
    state: RepairState


def repair_step(run: Run) -> StepMeans:
    """Draw instances, build their tours, and descend after each of many repairs.

    The numbers of objectives, from two to the configuration's, take turns.
    """
    actor, config = cast(OneActor, run.actor), run.config
    objectives = 2 + run.step % (config.objectives - 1)
    rows = rows_of(_preferences(run, config.preferences, objectives))
    few = -(-config.preferences // _ROWS_A_DRAW)
    chains = [_begun(actor, instance, rows) for instance in drawn_instances(run, objectives)]
    losses = []
    for number in torch.arange(_REPAIRS):
        if number % _BUILT_EVERY == 0:
            instances = drawn_instances(run, objectives)
            learn_to_build(run, instances, _preferences(run, few, objectives))
        drawn = torch.randperm(config.preferences, generator=run.instance_generator)[:few]
        chains, loss = _learned(run, chains, number, drawn.to(run.device))
        losses.append(loss)
    run.step += 1
    lengths = torch.cat([_weighted(chain, chain.state.points) for chain in chains])
    mean_loss = sum(losses) / len(losses)
    return StepMeans(mean_loss, objective=lengths.mean().item(), violation=0.0, multiplier=0.0)


def _preferences(run: Run, count: int, objectives: int) -> Tensor:
    return random_preferences(count, objectives, run.instance_generator, run.device)


@torch.no_grad()
def _begun(actor: OneActor, instance: Tensor, rows: Float[Tensor, "r m"]) -> _Chain:
    problem = actor.problem(instance, rows)
    least = least_costs(actor.first_candidates(problem))
    return _Chain(problem, least, unrepaired(problem.costs, actor.built(problem)))


def _learned(
    run: Run, chains: Sequence[_Chain], number: Int[Tensor, ""], rows: Int[Tensor, " d"]
) -> tuple[list[_Chain], float]:
    """Descend by repairs drawn for these rows; return the chains after the greedy repair."""
    actor, times = cast(OneActor, run.actor), run.config.starts
    sizes = sizes_of_cut(chains[0].least.shape[1], int(number))
    with torch.no_grad():
        cities = [
            cities_to_cut(problem, least, (state.tours, state.freshness), number, sizes)
            for problem, least, state in chains
        ]
        cuts = [cut(chain.state.tours, each) for chain, each in zip(chains, cities, strict=True)]
        problems = [
            repair_problem(as_repaired(chain.problem, chain.state.points), each)
            for chain, each in zip(chains, cuts, strict=True)
        ]
        costs = stacked([between for between, _ in problems])
        fragments = stacked([left for _, left in problems])
        few_costs = stacked([_of(rows, between) for between, _ in problems])
        few_fragments = stacked([_of(rows, left) for _, left in problems])
    costs_of_drawn = repeated(few_costs, times)
    drawn, likelihoods = joined_by_chance(
        actor.judgement(actor.repair_joinings),
        costs_of_drawn,
        repeated(few_fragments, times),
        run.sampling_generator,
        enough=ENOUGH,
    )
    with torch.no_grad():
        drawn_by_chain = split(joined_to_one(costs_of_drawn, drawn), len(chains))
        advantages = [
            _advantages(chain, rows, repeated(_of(rows, each), times), whole)
            for chain, each, whole in zip(chains, cuts, drawn_by_chain, strict=True)
        ]
    loss = (torch.cat(advantages) * likelihoods).mean()
    update(run, loss)
    with torch.no_grad():
        best = split(actor.rejoined(costs, fragments), len(chains))
        tours = map(laid_out, cuts, best)
        after = [_after(*each) for each in zip(chains, cities, tours, strict=True)]
    return after, loss.item()


def _of(rows: Int[Tensor, " d"], every: Rows) -> Rows:
    return changed(every, lambda member: member.index_select(0, rows))


def _advantages(
    chain: _Chain, rows: Int[Tensor, " d"], cuts: Cuts, whole: Fragments
) -> Float[Tensor, " dt"]:
    """Return how much worse each tour is than the mean of those drawn for the same row."""
    kept, weights = chain.state.points, chain.problem.weights
    tours = laid_out(cuts, whole)
    times = len(tours) // len(rows)
    by_tour = weights[rows].repeat_interleave(times, dim=0)
    points = cheaper_way(chain.problem.costs, by_tour, tours)[1]
    slopes = slopes_for_rows(weights, kept)[rows]
    before = (kept[rows] * slopes).sum(dim=1, keepdim=True)
    longer = (points.unflatten(0, (-1, times)) * slopes[:, None]).sum(dim=2) / before - 1
    gains = gains_for_rows(weights, kept, points).view_as(longer)
    objectives = chain.state.tours.shape[1] * (_LENGTH * longer - gains)  # in edges of mean length
    return (objectives - objectives.mean(dim=1, keepdim=True)).flatten()


def _after(chain: _Chain, cities: Int[Tensor, "r m"], tours: Int[Tensor, "r n"]) -> _Chain:
    problem = chain.problem
    state = state_after_repair(problem.costs, problem.weights, chain.state, cities, tours)
    return chain._replace(state=state)


def _weighted(chain: _Chain, points: Float[Tensor, "r m"]) -> Float[Tensor, " r"]:
    return (points * chain.problem.weights).sum(dim=1)
