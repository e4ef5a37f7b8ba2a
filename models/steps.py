"""Training steps on tours: policy gradient, as in Algorithm 1 of the paper, and imitation.

Mehta, Taghipour and Saeedi (2022), arXiv:2203.01298.
"""

import math
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float
from torch import Generator, Tensor, nn
from torch.optim import Optimizer

from models.checkpoint import Run
from models.config import TrainingConfig
from models.data.dataset import Batch, Labels
from models.data.instances import city_count, tour_lengths, uniform_cities
from models.data.matrices import any_matrices
from models.data.preferences import fan_of_preferences, random_preferences
from models.lagrangian import ascended, lagrangian, violation, weighted_sum
from models.networks.matrix_features import unit_matrices


@dataclass(frozen=True)
class StepMeans:
    """The measures of one step, means over its tours."""

    loss: float
    objective: float
    violation: float
    multiplier: float


def policy_gradient_step(run: Run) -> StepMeans:
    """Take one step of Algorithm 1, for all instances and preferences at once."""
    means = learn_to_build(run, drawn_instances(run), drawn_preferences(run))
    run.step += 1
    return means


def learn_to_build(run: Run, instances: Tensor, preferences: Float[Tensor, "k m"]) -> StepMeans:
    """Descend once by the policy gradient of tours that the actor builds of these instances."""
    config = run.config
    run.actor.train()
    with _precision(run):
        tours, likelihoods = run.actor.sampled_tours_with_log_likelihoods(
            instances, preferences, config.starts, run.instance_generator, run.sampling_generator
        )
    points = tour_lengths(instances, tours)
    by_tour = preferences.repeat_interleave(config.starts, dim=0)
    if config.objective == "lagrangian":
        multipliers = run.multipliers.repeat_interleave(config.starts)
        objectives = lagrangian(points, by_tour, multipliers)
    else:
        objectives = weighted_sum(points, by_tour)

    advantages = objectives - _baseline(run, instances, preferences, objectives)
    loss = (advantages * likelihoods).mean()
    update(run, loss)

    violations = violation(points, by_tour)
    if config.objective == "lagrangian":
        by_start = violations.unflatten(1, (config.preferences, config.starts)).transpose(1, 2)
        run.multipliers = ascended(
            run.multipliers,
            by_start.flatten(0, 1),
            config.ascent_rate,
            (config.least_multiplier, config.most_multiplier),
        )
    return StepMeans(
        loss=loss.item(),
        objective=objectives.mean().item(),
        violation=violations.mean().item(),
        multiplier=run.multipliers.mean().item(),
    )


def imitation_step(run: Run, labels: Labels) -> StepMeans:
    """Take one step towards the tours of the expert."""
    config = run.config
    run.actor.train()
    starts = config.starts if run.actor.imitates_starts else 1
    drawn = labels.batch(config.instances, config.preferences, starts, run.instance_generator)
    instances, preferences, tours = Batch(*(part.to(run.device) for part in drawn))
    with _precision(run):
        loss = run.actor.imitation_loss(instances, preferences, tours)
    update(run, loss)
    run.step += 1
    points = tour_lengths(instances, tours)
    by_tour = preferences.repeat_interleave(starts, dim=0)
    return StepMeans(
        loss=loss.item(),
        objective=weighted_sum(points, by_tour).mean().item(),
        violation=violation(points, by_tour).mean().item(),
        multiplier=0.0,
    )


def descend(optimizer: Optimizer, network: nn.Module, loss: Tensor, clip_gradient: float) -> None:
    """Take one step down the gradient of the loss, whose norm is clipped."""
    optimizer.zero_grad()
    loss.backward()
    nn.utils.clip_grad_norm_(network.parameters(), clip_gradient)
    optimizer.step()


def drawn_instances(run: Run, objectives: int | None = None) -> Tensor:
    """Draw instances of the kind that the actor reads, all with the same number of cities.

    They have as many objectives as the configuration says, unless others are given.
    """
    config, generator = run.config, run.instance_generator
    n = city_count(config.least_cities, config.most_cities, generator)
    if run.actor.reads == "coordinates":
        objectives = objectives or config.objectives
        return uniform_cities(config.instances, n, generator, run.device, objectives)
    drawn = np.stack(
        [any_matrices(n, _numpy_generator(generator)) for _ in range(config.instances)]
    )
    return unit_matrices(torch.from_numpy(drawn.astype(np.float32)).to(run.device))


def _numpy_generator(generator: Generator) -> np.random.Generator:
    """Return a generator of numpy whose seed the generator draws."""
    return np.random.default_rng(int(torch.randint(2**62, (), generator=generator)))


def drawn_preferences(run: Run) -> Tensor:
    """Return the paper's fixed fan if each preference has a multiplier; else draw preferences."""
    if run.config.objective == "lagrangian":
        return fan_of_preferences(run.config.preferences, run.device)
    config = run.config
    return random_preferences(
        config.preferences, config.objectives, run.instance_generator, run.device
    )


def _baseline(run: Run, instances: Tensor, preferences: Tensor, objectives: Tensor) -> Tensor:
    """Return the expected objective of each tour: the critic's, or the mean over the starts."""
    if run.config.baseline == "shared":
        by_start = objectives.unflatten(1, (len(preferences), run.config.starts))
        return by_start.mean(dim=-1, keepdim=True).expand_as(by_start).flatten(1)
    predicted: Tensor = run.critic(instances, preferences)
    error = ((predicted - objectives) ** 2).mean()
    _descend_at_schedule(run, run.critic_optimizer, run.critic, error)
    return predicted.detach()


def update(run: Run, loss: Tensor) -> None:
    """Move the actor down its loss, and the average of its weights after it."""
    _descend_at_schedule(run, run.optimizer, run.actor, loss)
    run.averaged.update_parameters(run.actor)


def _descend_at_schedule(run: Run, optimizer: Optimizer, network: nn.Module, loss: Tensor) -> None:
    for group in optimizer.param_groups:
        group["lr"] = _learning_rate(run.config, run.step)
    descend(optimizer, network, loss, run.config.clip_gradient)


def _learning_rate(config: TrainingConfig, step: int) -> float:
    """Return the rate: up in a line over the warm-up, then down half a cosine to the last step."""
    if step < config.warmup:
        return config.learning_rate * (step + 1) / config.warmup
    done = (step - config.warmup) / max(1, config.steps - config.warmup)
    return config.learning_rate * (1 + math.cos(math.pi * min(1.0, done))) / 2


def _precision(run: Run) -> AbstractContextManager[object]:
    if run.precision == torch.float32:
        return nullcontext()
    return torch.autocast(run.device.type, run.precision)
