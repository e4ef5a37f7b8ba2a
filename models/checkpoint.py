"""All that a training run is at one moment; a run resumed from it equals one never stopped."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, cast

import torch
from torch import Generator, Tensor, nn
from torch.optim import Adam
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn

from models.config import TrainingConfig, as_plain, from_plain
from models.networks.build import Actor, build
from models.networks.critic import Critic
from models.networks.layers import FadingLayer
from models.networks.pa_one import OneActor, TellingLayer


@dataclass
class Run:
    """A training run: weights, optimisers, multipliers, generators, and how far it has come.

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


_STATEFUL = ("actor", "averaged", "critic", "optimizer", "critic_optimizer")
_GENERATORS = ("instance_generator", "sampling_generator")


def new_run(config: TrainingConfig, device: torch.device) -> Run:
    """A run at its beginning; everything random follows from the configuration's seed."""
    actor = build(config.network, config.seed).to(device)
    with torch.random.fork_rng():
        torch.manual_seed(config.seed + 1)
        critic = Critic(config.network, actor.reads).to(device)
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
    """Writes the run; the file at path is the old one or the new one, never a torn one."""
    state: dict[str, Any] = {name: getattr(run, name).state_dict() for name in _STATEFUL}
    state |= {name: getattr(run, name).get_state() for name in _GENERATORS}
    state |= {"config": as_plain(run.config), "multipliers": run.multipliers}
    state |= {"step": run.step, "seconds": run.seconds}
    unfinished = path.with_suffix(".part")
    torch.save(state, unfinished)
    os.replace(unfinished, path)


def resume(path: Path, device: torch.device) -> Run:
    """The run that was saved at path."""
    state = torch.load(path, map_location="cpu", weights_only=True)
    run = new_run(from_plain(state["config"]), device)
    for name in _STATEFUL:
        getattr(run, name).load_state_dict(state[name])
    for name in _GENERATORS:
        getattr(run, name).set_state(state[name])
    run.multipliers = state["multipliers"].to(device)
    run.step, run.seconds = state["step"], state["seconds"]
    return run


class Trained(NamedTuple):
    """A released checkpoint: what was trained, how, and for how long."""

    config: TrainingConfig
    actor: Actor
    step: int
    seconds: float


def save_weights(run: Run, path: Path) -> None:
    """Writes what a released checkpoint holds: averaged weights, configuration, steps, seconds."""
    write(Trained(run.config, averaged_actor(run), run.step, run.seconds), path)


def write(trained: Trained, path: Path) -> None:
    """Writes a checkpoint that `load_weights` reads."""
    state = trained._asdict()
    state |= {"config": as_plain(trained.config), "actor": trained.actor.state_dict()}
    torch.save(state, path)


def load_weights(path: Path) -> Trained:
    """The released checkpoint at path."""
    state = torch.load(path, map_location="cpu", weights_only=True)
    config = from_plain(state["config"])
    actor = build(config.network, config.seed)
    actor.load_state_dict(state["actor"])
    return Trained(config, actor.eval(), state["step"], state["seconds"])


def averaged_actor(run: Run) -> Actor:
    """The actor with averaged weights: the one that is validated and released."""
    return cast(Actor, run.averaged.module)


def start_from(run: Run, weights: Actor) -> None:
    """Gives a run at its beginning the weights of another actor: one of its shape, or shallower.

    The layers that the shallower one lacks change nothing at first.
    """
    state = weights.state_dict()
    if len(_layers(run.actor)) > len(_layers(weights)):
        state = _silenced(run.actor, len(_layers(weights))) | state
    run.actor.load_state_dict(state)
    averaged_actor(run).load_state_dict(state)


def _layers(actor: Actor) -> nn.ModuleList:
    return actor.layers if isinstance(actor, OneActor) else actor.encoder.layers


def _silenced(actor: Actor, depth: int) -> dict[str, Tensor]:
    """The weights of an actor of which the layers from depth on add nothing."""
    for layer in _layers(actor)[depth:]:
        if not isinstance(layer, FadingLayer | TellingLayer):
            raise ValueError(f"{type(actor).__name__} must begin from weights of as many layers")
        layer.silence()
    return actor.state_dict()
