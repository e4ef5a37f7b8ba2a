"""Training steps on repairs: policy gradient on what it gains to join anew what cuts have left.

The states are those that repairs meet: tours as the actor builds them, then after one repair of
its own, after two, and so on. Now and then it learns from building tours, too, so that it does not
unlearn that.
"""

from collections.abc import Callable, Iterable, Sequence
from operator import itemgetter
from typing import Any, NamedTuple, TypeVar, cast

import torch
from jaxtyping import Float, Int
from torch import Tensor

from models.checkpoint import Run
from models.data.preferences import turned_outwards, weights
from models.networks.joining.costs import Costs, Problem
from models.networks.joining.fragments import Fragments
from models.networks.joining.repairs import Cuts, cut, laid_out, last_two_joined, repair_problem
from models.networks.pa_one import OneActor
from models.rollout_pa_one import joined_by_chance
from models.rollout_repairs import (
    CITIES,
    NEAR,
    RepairState,
    cheaper_way,
    cities_near,
    least_costs,
    ranks_to_cut,
    state_after_repair,
    unrepaired,
)
from models.steps import StepMeans, drawn_instances, drawn_preferences, learn_to_build, update

_REPAIRS = 60  # of each tour, one after another
_BUILT_EVERY = 8  # repairs
_LEAK = 0.25  # what a tour longer than before counts, for one that is as much shorter

Rows = TypeVar("Rows", Costs, Fragments, Cuts)


class _Chain(NamedTuple):
    """The tours of one instance on their way through the repairs."""

    problem: Problem
    least: Float[Tensor, "r n"]
    state: RepairState


def repair_step(run: Run) -> StepMeans:
    """Draw instances, build their tours, and descend after each of many repairs."""
    actor = cast(OneActor, run.actor)
    preferences = weights(turned_outwards(drawn_preferences(run)))
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
def _begun(actor: OneActor, instance: Tensor, rows: Float[Tensor, "r 2"]) -> _Chain:
    problem = actor.problem(instance, rows)
    least = least_costs(actor.first_candidates(problem))
    return _Chain(problem, least, unrepaired(problem.costs, actor.built(problem)))


def _learned(
    run: Run, chains: Sequence[_Chain], number: Int[Tensor, ""]
) -> tuple[list[_Chain], float]:
    """Descend by repairs drawn for each tour; return the chains after the greedy repair."""
    actor, times = cast(OneActor, run.actor), run.config.starts
    with torch.no_grad():
        cities = [_cities_to_cut(chain, number) for chain in chains]
        cuts = [cut(chain.state.tours, each) for chain, each in zip(chains, cities, strict=True)]
        problems = [
            repair_problem(chain.problem, each) for chain, each in zip(chains, cuts, strict=True)
        ]
        costs = _stacked([between for between, _ in problems])
        fragments = _stacked([left for _, left in problems])
    repeated = _repeated(costs, times)
    drawn, likelihoods = joined_by_chance(
        actor.edge_logits,
        repeated,
        _repeated(fragments, times),
        actor.repair_joinings,
        run.sampling_generator,
        enough=2,
    )
    with torch.no_grad():
        drawn_by_chain = _split(last_two_joined(repeated, drawn), len(chains))
        advantages = [
            _advantages(chain, _repeated(each, times), whole)
            for chain, each, whole in zip(chains, cuts, drawn_by_chain, strict=True)
        ]
    loss = (torch.cat(advantages) * likelihoods).mean()
    update(run, loss)
    with torch.no_grad():
        best = _split(
            actor.joined_to_one(costs, fragments.trimmed(), actor.repair_joinings), len(chains)
        )
        tours = map(laid_out, cuts, best)
        after = [_after(*each) for each in zip(chains, cities, tours, strict=True)]
    return after, loss.item()


def _cities_to_cut(chain: _Chain, number: Int[Tensor, ""]) -> Int[Tensor, "r m"]:
    problem, least, state = chain
    n = least.shape[1]
    near = cities_near(problem, least, state.tours, state.freshness, min(NEAR, n))
    return near.index_select(1, ranks_to_cut(number, min(NEAR, n), min(CITIES, n)))


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


def _weighted(chain: _Chain, points: Float[Tensor, "r 2"]) -> Float[Tensor, " r"]:
    return (points * chain.problem.weights).sum(dim=1)


def _stacked(parts: Sequence[Rows]) -> Rows:
    """Return the rows of all parts, one part after the other."""
    members: Iterable[Any] = zip(*parts, strict=True)
    return _made(
        type(parts[0]), (each[0] if each[0] is None else torch.cat(each) for each in members)
    )


def _repeated(rows: Rows, times: int) -> Rows:
    """Return each row several times, one copy after the other."""
    return _changed(rows, lambda member: member.repeat_interleave(times, dim=0))


def _split(rows: Rows, count: int) -> list[Rows]:
    """Return as many parts of equally many rows."""
    size = len(rows[0]) // count
    return [_changed(rows, itemgetter(slice(i * size, (i + 1) * size))) for i in range(count)]


def _changed(rows: Rows, change: Callable[[Tensor], Tensor]) -> Rows:
    return _made(type(rows), (member if member is None else change(member) for member in rows))


def _made(kind: type[Rows], members: Iterable[Any]) -> Rows:
    return kind(*members)
