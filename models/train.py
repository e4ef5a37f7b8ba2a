"""Training: Algorithm 1 of Mehta, Taghipour and Saeedi (2022), arXiv:2203.01298.

`python -m models.train --out runs/one` begins a run or, where one lies there, goes on with it.
Beside the checkpoint it writes its configuration, a log (CSV) and a curve (PNG). With
`--objective imitation --labels FOLDER` the actor learns the tours of `models.expert` instead.
"""

import argparse
import math
import time
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from pathlib import Path

import torch
from torch import Tensor

from models.checkpoint import (
    Run,
    averaged_actor,
    load_weights,
    new_run,
    resume,
    save,
    save_weights,
    start_from,
)
from models.config import NetworkConfig, TrainingConfig, add_options, from_options
from models.data.dataset import Batch, Labels
from models.data.instances import tour_lengths
from models.data.sampling import (
    city_count,
    distinct_starts,
    fan_of_preferences,
    spread_preferences,
    uniform_instances,
)
from models.lagrangian import ascended, lagrangian, violation, weighted_sum
from models.networks.build import Memory
from models.networks.pa_one import OneActor
from models.rollout import (
    log_likelihoods,
    log_likelihoods_by_city,
    repeated,
    roll_out,
    sampling,
)
from models.rollout_pa_one import imitation_loss, sampled_tours
from models.training_log import Record, Step
from models.validation import (
    COUNTS,
    ValidationSet,
    greedy_tours,
    mean_hypervolume,
    validation_sets,
)


def train(
    run: Run,
    steps: int,
    validation: list[ValidationSet],
    out: Path,
    labels: Labels | None = None,
) -> None:
    """Takes the run up to the given step, writing to the folder out as it goes."""
    if (labels is None) == (run.config.objective == "imitation"):
        raise ValueError("labels must be given for imitation, and for nothing else")
    with Record(out, run, steps) as record:
        while run.step < steps:
            began = time.perf_counter()
            record.stepped(policy_gradient_step(run) if labels is None else imitate(run, labels))
            run.seconds += time.perf_counter() - began
            if run.step % run.config.validate_every == 0 or run.step == steps:
                build = partial(greedy_tours, averaged_actor(run).eval())
                record.validated({v.cities: mean_hypervolume(build, v) for v in validation})
                save(run, out / "run.pt")
                save_weights(run, out / "weights.pt")


def policy_gradient_step(run: Run) -> Step:
    """One iteration of Algorithm 1, for all instances and preferences at once."""
    config = run.config
    run.actor.train()
    instances = _sample_instances(run)
    preferences = _preferences(run)
    tours, likelihoods = _drawn(run, instances, preferences)
    points = tour_lengths(instances, tours)
    each = preferences.repeat_interleave(config.starts, dim=0)
    if config.objective == "lagrangian":
        multipliers = run.multipliers.repeat_interleave(config.starts)
        objectives = lagrangian(points, each, multipliers)
    else:
        objectives = weighted_sum(points, each)

    advantages = objectives - _baseline(run, instances, preferences, objectives)
    loss = (advantages * likelihoods).mean()
    _learn(run, loss)

    violations = violation(points, each)
    run.multipliers = ascended(
        run.multipliers,
        violations.unflatten(1, (config.preferences, config.starts)).transpose(1, 2).flatten(0, 1),
        config.ascent_rate,
        (config.least_multiplier, config.most_multiplier),
    )
    return Step(
        loss=loss.item(),
        objective=objectives.mean().item(),
        violation=violations.mean().item(),
        multiplier=run.multipliers.mean().item(),
    )


def imitate(run: Run, labels: Labels) -> Step:
    """One step towards the expert."""
    config = run.config
    run.actor.train()
    # PA-One learns edges, for which it is all one where a tour starts.
    starts = 1 if isinstance(run.actor, OneActor) else config.starts
    given = labels.batch(config.instances, config.preferences, starts, run.instance_generator)
    batch = Batch(*(part.to(run.device) for part in given))
    loss = _imitation_loss(run, batch)
    _learn(run, loss)
    instances, preferences, tours = batch
    points = tour_lengths(instances, tours)
    each = preferences.repeat_interleave(starts, dim=0)
    return Step(
        loss=loss.item(),
        objective=weighted_sum(points, each).mean().item(),
        violation=violation(points, each).mean().item(),
        multiplier=0.0,
    )


def _drawn(run: Run, instances: Tensor, preferences: Tensor) -> tuple[Tensor, Tensor]:
    """Tours of the instances, several for each preference in turn, and their log-likelihoods."""
    config, actor, generator = run.config, run.actor, run.sampling_generator
    if isinstance(actor, OneActor):
        return sampled_tours(actor, instances, preferences, config.starts, generator)
    starts = distinct_starts(
        config.instances,
        instances.shape[-2],
        config.starts,
        run.instance_generator,
        run.device,
    ).repeat(1, config.preferences)
    with _precision(run):
        memory = actor.remember(instances, preferences)
        rows = repeated(actor.decoder.condition(preferences), config.starts)
        tours = roll_out(actor, _detached(memory), rows, starts, sampling(generator))
        return tours, log_likelihoods(actor, memory, rows, tours)


def _imitation_loss(run: Run, batch: Batch) -> Tensor:
    """What a choice that the expert's tours ask for costs in likelihood."""
    if isinstance(run.actor, OneActor):
        return imitation_loss(run.actor, batch)
    instances, preferences, tours = batch
    with _precision(run):
        memory = run.actor.remember(instances, preferences)
        rows = repeated(run.actor.decoder.condition(preferences), run.config.starts)
        return -log_likelihoods_by_city(run.actor, memory, rows, tours).mean()


def _sample_instances(run: Run) -> Tensor:
    config, generator = run.config, run.instance_generator
    n = city_count(config.least_cities, config.most_cities, generator)
    return uniform_instances(run.actor.reads, config.instances, n, generator, run.device)


def _preferences(run: Run) -> Tensor:
    """The paper's fixed fan where each preference has a multiplier; else drawn anew."""
    if run.config.objective == "lagrangian":
        return fan_of_preferences(run.config.preferences, run.device)
    return spread_preferences(run.config.preferences, run.instance_generator, run.device)


def _baseline(run: Run, instances: Tensor, preferences: Tensor, objectives: Tensor) -> Tensor:
    """What to expect of each tour: the critic's word, or the mean over the starts."""
    if run.config.baseline == "shared":
        by_start = objectives.unflatten(1, (run.config.preferences, run.config.starts))
        return by_start.mean(dim=-1, keepdim=True).expand_as(by_start).flatten(1)
    predicted: Tensor = run.critic(instances, preferences)
    _descend(run, run.critic_optimizer, run.critic, ((predicted - objectives) ** 2).mean())
    return predicted.detach()


def _learn(run: Run, loss: Tensor) -> None:
    """Ends a step: the actor goes down its loss, and its average follows."""
    _descend(run, run.optimizer, run.actor, loss)
    run.averaged.update_parameters(run.actor)
    run.step += 1


def _descend(
    run: Run, optimizer: torch.optim.Optimizer, network: torch.nn.Module, loss: Tensor
) -> None:
    for group in optimizer.param_groups:
        group["lr"] = _learning_rate(run)
    optimizer.zero_grad()
    loss.backward()
    torch.nn.utils.clip_grad_norm_(network.parameters(), run.config.clip_gradient)
    optimizer.step()


def _learning_rate(run: Run) -> float:
    """Up in a line over the warm-up, then down along half a cosine to the last step."""
    config = run.config
    if run.step < config.warmup:
        return config.learning_rate * (run.step + 1) / config.warmup
    done = (run.step - config.warmup) / max(1, config.steps - config.warmup)
    return config.learning_rate * (1 + math.cos(math.pi * min(1.0, done))) / 2


def _precision(run: Run) -> AbstractContextManager[object]:
    if run.precision == torch.float32:
        return nullcontext()
    return torch.autocast(run.device.type, run.precision)


def _detached(memory: Memory) -> Memory:
    return type(memory)(*(table.detach() for table in memory))


def main(arguments: list[str] | None = None) -> None:
    """The command line."""
    options = _parser().parse_args(arguments)
    device = torch.device(options.device)
    saved = options.out / "run.pt"
    if saved.exists():
        run = resume(saved, device)
    else:
        network = from_options(NetworkConfig, options)
        run = new_run(from_options(TrainingConfig, options, network=network), device)
        if options.initial:
            start_from(run, load_weights(options.initial).actor)
    run.precision = getattr(torch, options.precision)
    if isinstance(run.actor, OneActor) and run.precision != torch.float32:
        raise ValueError(f"pa-one trains in float32, got precision {options.precision}")
    labels = Labels(options.labels) if options.labels else None
    validation = validation_sets(run.actor.reads, COUNTS, device)
    train(run, run.config.steps, validation, options.out, labels)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("python -m models.train", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of the run")
    parser.add_argument("--device", default="cpu", help="cpu or cuda")
    parser.add_argument(
        "--precision",
        choices=("float32", "bfloat16"),
        default="float32",
        help="of products; bfloat16 is faster on a GPU, and on a CPU that has instructions for it",
    )
    parser.add_argument("--initial", type=Path, help="checkpoint whose weights a new run takes")
    parser.add_argument("--labels", type=Path, help="folder of shards, for imitation")
    add_options(parser, NetworkConfig)
    add_options(parser, TrainingConfig)
    return parser


if __name__ == "__main__":
    main()
