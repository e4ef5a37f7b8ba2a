"""Checkpoints: training runs that can be resumed, and the weights that are released.

A run that is resumed from its checkpoint equals one that never stopped.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, cast

import torch
from torch import Generator, Tensor
from torch.optim import Adam
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn

from models.config import TrainingConfig, as_plain, from_plain
from models.networks.actor import Actor
from models.networks.build import build
from models.networks.critic import Critic


@dataclass
class Run:
    """A training run: weights, optimisers, multipliers, generators, steps and seconds so far.

    Products are computed in its precision; weights and losses are of float32.
    """

    config: TrainingConfig
    device: torch.device
    actor: Actor
    averaged: AveragedModel
    critic: Critic
    optimizer: Adam
    critic_optimizer: Adam
    multipliers: Tensor
    instance_generator: Generator
    sampling_generator: Generator
    step: int = 0
    seconds: float = 0.0
    precision: torch.dtype = torch.float32


GENERATORS = ("instance_generator", "sampling_generator")
_STATEFUL = ("actor", "averaged", "critic", "optimizer", "critic_optimizer")


def new_run(config: TrainingConfig, device: torch.device) -> Run:
    """Return a run at its beginning; everything random follows from the configuration's seed."""
    actor = build(config.network, config.seed).to(device)
    with torch.random.fork_rng():
        torch.manual_seed(config.seed + 1)
        critic = Critic(config.network, actor.reads, config.objectives).to(device)
    return Run(
        config=config,
        device=device,
        actor=actor,
        averaged=AveragedModel(
            actor, multi_avg_fn=get_ema_multi_avg_fn(config.averaging), use_buffers=True
        ),
        critic=critic,
        optimizer=Adam(actor.parameters(), lr=config.learning_rate),
        critic_optimizer=Adam(critic.parameters(), lr=config.learning_rate),
        multipliers=torch.full((config.preferences,), config.multiplier, device=device),
        instance_generator=Generator().manual_seed(config.seed + 2),
        sampling_generator=Generator(device).manual_seed(config.seed + 3),
    )


def save(run: Run, path: Path) -> None:
    """Write the run."""
    state = state_of(run, _STATEFUL)
    state |= {"config": as_plain(run.config), "multipliers": run.multipliers}
    write_whole(state, path)


def resume(path: Path, device: torch.device) -> Run:
    """Return the run that was saved at path."""
    state = torch.load(path, map_location="cpu", weights_only=True)
    run = new_run(from_plain(state["config"]), device)
    restore(run, state, _STATEFUL)
    run.multipliers = state["multipliers"].to(device)
    return run


def state_of(run: Any, stateful: Sequence[str]) -> dict[str, Any]:
    """Return the state of a run: stateful parts by name, generators, step and seconds."""
    state: dict[str, Any] = {name: getattr(run, name).state_dict() for name in stateful}
    state |= {name: getattr(run, name).get_state() for name in GENERATORS}
    return state | {"step": run.step, "seconds": run.seconds}


def restore(run: Any, state: dict[str, Any], stateful: Sequence[str]) -> None:
    """Give a new run the state that `state_of` returned."""
    for name in stateful:
        getattr(run, name).load_state_dict(state[name])
    for name in GENERATORS:
        getattr(run, name).set_state(state[name])
    run.step, run.seconds = state["step"], state["seconds"]


def write_whole(state: dict[str, Any], path: Path) -> None:
    """Replace a file at once: at any moment it is the old one or the new one."""
    unfinished = path.with_suffix(".part")
    torch.save(state, unfinished)
    os.replace(unfinished, path)


class Trained(NamedTuple):
    """A released checkpoint: the trained actor, its configuration, steps and seconds."""

    config: TrainingConfig
    actor: Actor
    step: int
    seconds: float


def save_weights(run: Run, path: Path) -> None:
    """Write the released checkpoint of a run: averaged weights, configuration, steps, seconds."""
    write(Trained(run.config, averaged_actor(run), run.step, run.seconds), path)


def write(trained: Trained, path: Path) -> None:
    """Write a checkpoint that `load_weights` reads."""
    state = trained._asdict()
    state |= {"config": as_plain(trained.config), "actor": trained.actor.state_dict()}
    write_whole(state, path)


def load_weights(path: Path) -> Trained:
    """Return the released checkpoint at path."""
    state = torch.load(path, map_location="cpu", weights_only=True)
    config = from_plain(state["config"])
    actor = build(config.network, config.seed)
    actor.load_state_dict(state["actor"])
    return Trained(config, actor.eval(), state["step"], state["seconds"])


def averaged_actor(run: Run) -> Actor:
    """Return the actor with averaged weights: the one that is validated and released."""
    return cast(Actor, run.averaged.module)


def start_from(run: Run, trained: Actor) -> None:
    """Give a run at its beginning the weights of an actor of its shape, or a shallower one.

    The layers that the shallower one lacks change nothing at first.

    Raises:
        ValueError: the actor is shallower, and its layers cannot begin by changing nothing.
    """
    state = trained.state_dict()
    depth = len(trained.encoder_layers)
    if len(run.actor.encoder_layers) > depth:
        run.actor.silence_layers(depth)
        state = run.actor.state_dict() | state
    run.actor.load_state_dict(state)
    averaged_actor(run).load_state_dict(state)
