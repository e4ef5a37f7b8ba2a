"""DRL-MOA, the rival: one network for each weighted sum, each begun from its neighbour's.

Li, Zhang and Wang (2020), arXiv:1906.02386. `python -m models.drl_moa --out runs/drl-moa` begins a
run or, where one lies there, goes on with it; `weights.pt` holds the networks finished so far.
Subproblems go from the first length alone to the second alone, in equal steps of the weights.
"""

import argparse
import csv
import os
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import torch
from jaxtyping import Float
from torch import Generator, Tensor, nn
from torch.optim import Adam
from tqdm import tqdm

from models.config import add_options, from_options, setting
from models.data.instances import tour_lengths
from models.data.sampling import uniform_cities
from models.networks.pointer_network import (
    PointerActor,
    PointerCritic,
    build_tours,
    log_likelihoods,
)
from models.rollout import sampling


@dataclass(frozen=True, kw_only=True)
class TransferConfig:
    """The subproblems and the training of each; the paper has 100 of 2500 steps, 40 cities."""

    subproblems: int = setting(100, "weighted sums, and so networks")
    first_steps: int = setting(2500, "gradient steps of the first network")
    steps: int = setting(2500, "gradient steps of every other network")
    instances: int = setting(200, "instances a step")
    cities: int = setting(40, "cities of an instance")
    width: int = setting(128, "features of a city, and of the recurrent state")
    learning_rate: float = setting(5e-4, "of actor and critic")
    clip_gradient: float = setting(2.0, "bound on the norm of the gradient")
    save_every: int = setting(100, "steps between two checkpoints")
    seed: int = setting(1, "of weights, instances and sampling")

    def __post_init__(self) -> None:
        if self.subproblems < 2:
            raise ValueError(f"subproblems must be at least 2, got {self.subproblems}")
        for name in ("first_steps", "steps", "instances", "cities", "width", "save_every"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} must be at least 1, got {getattr(self, name)}")


@dataclass
class TransferRun:
    """The networks that are finished, and the one in training with how far it has come."""

    config: TransferConfig
    actor: PointerActor
    critic: PointerCritic
    optimizer: Adam
    critic_optimizer: Adam
    instance_generator: Generator
    sampling_generator: Generator
    finished: list[dict[str, Tensor]]
    step: int = 0
    seconds: float = 0.0

    @property
    def weights(self) -> Float[Tensor, " 2"]:
        """Of the subproblem in training: from the first length alone to the second alone."""
        second = len(self.finished) / (self.config.subproblems - 1)
        return torch.tensor([1 - second, second])

    @property
    def steps(self) -> int:
        """Of the subproblem in training."""
        return self.config.steps if self.finished else self.config.first_steps


_STATEFUL = ("actor", "critic", "optimizer", "critic_optimizer")
_GENERATORS = ("instance_generator", "sampling_generator")


def new_run(config: TransferConfig) -> TransferRun:
    """A run at its beginning; everything random follows from the configuration's seed."""
    with torch.random.fork_rng():
        torch.manual_seed(config.seed)
        actor, critic = PointerActor(config.width), PointerCritic(config.width)
    return TransferRun(
        config=config,
        actor=actor,
        critic=critic,
        optimizer=Adam(actor.parameters(), lr=config.learning_rate),
        critic_optimizer=Adam(critic.parameters(), lr=config.learning_rate),
        instance_generator=Generator().manual_seed(config.seed + 1),
        sampling_generator=Generator().manual_seed(config.seed + 2),
        finished=[],
    )


def save(run: TransferRun, path: Path) -> None:
    """Writes the run; the file at path is the old one or the new one, never a torn one."""
    state: dict[str, Any] = {name: getattr(run, name).state_dict() for name in _STATEFUL}
    state |= {name: getattr(run, name).get_state() for name in _GENERATORS}
    state |= {"config": asdict(run.config), "finished": run.finished}
    state |= {"step": run.step, "seconds": run.seconds}
    unfinished = path.with_suffix(".part")
    torch.save(state, unfinished)
    os.replace(unfinished, path)


def resume(path: Path) -> TransferRun:
    """The run that was saved at path."""
    state = torch.load(path, weights_only=True)
    run = new_run(TransferConfig(**state["config"]))
    for name in _STATEFUL:
        getattr(run, name).load_state_dict(state[name])
    for name in _GENERATORS:
        getattr(run, name).set_state(state[name])
    run.finished, run.step, run.seconds = state["finished"], state["step"], state["seconds"]
    return run


def train(run: TransferRun, out: Path) -> None:
    """Takes the run to its end, writing to the folder out as it goes."""
    out.mkdir(parents=True, exist_ok=True)
    config = run.config
    left = (config.subproblems - len(run.finished)) * config.steps - run.step
    with tqdm(total=left + config.first_steps - config.steps, unit="step") as bar:
        while len(run.finished) < config.subproblems:
            objective = take_step(run)
            bar.set_postfix_str(f"network {len(run.finished) + 1} objective {objective:.3f}")
            bar.update()
            if run.step == run.steps:
                _append_line(run, objective, out / "log.csv")
                finish(run)
                save_weights(run, out / "weights.pt")
            if run.step % config.save_every == 0:
                save(run, out / "run.pt")


def take_step(run: TransferRun) -> float:
    """One step of the subproblem in training; returns the mean objective of its tours."""
    began = time.perf_counter()
    config = run.config
    cities = uniform_cities(
        config.instances, config.cities, run.instance_generator, torch.device("cpu")
    )
    tours = build_tours(run.actor, cities, sampling(run.sampling_generator))
    objectives = tour_lengths(cities, tours[:, None])[:, 0] @ run.weights
    predicted = run.critic(cities)
    advantages = objectives - predicted.detach()
    loss = (advantages * log_likelihoods(run.actor, cities, tours)).mean()
    _descend(run.optimizer, run.actor, loss, config.clip_gradient)
    error = ((predicted - objectives) ** 2).mean()
    _descend(run.critic_optimizer, run.critic, error, config.clip_gradient)
    run.step += 1
    run.seconds += time.perf_counter() - began
    return objectives.mean().item()


def finish(run: TransferRun) -> None:
    """Puts the network in training among the finished ones; the next begins with its weights."""
    run.finished.append({name: x.clone() for name, x in run.actor.state_dict().items()})
    run.step = 0
    rate = run.config.learning_rate
    run.optimizer = Adam(run.actor.parameters(), lr=rate)
    run.critic_optimizer = Adam(run.critic.parameters(), lr=rate)


def _descend(optimizer: Adam, network: nn.Module, loss: Tensor, most: float) -> None:
    optimizer.zero_grad()
    loss.backward()
    nn.utils.clip_grad_norm_(network.parameters(), most)
    optimizer.step()


def _append_line(run: TransferRun, objective: float, path: Path) -> None:
    line = {
        "weight_1": f"{run.weights[0]:.4f}",
        "steps": run.step,
        "seconds": f"{run.seconds:.1f}",
        "objective": f"{objective:.4f}",
    }
    new = not path.exists()
    with path.open("a", newline="") as file:
        writer = csv.DictWriter(file, line)
        if new:
            writer.writeheader()
        writer.writerow(line)


def save_weights(run: TransferRun, path: Path) -> None:
    """Writes the finished networks, their configuration and the seconds that they took.

    In half precision: there may be a hundred of them.
    """
    actors = [{name: x.half() for name, x in each.items()} for each in run.finished]
    state = {"config": asdict(run.config), "actors": actors, "seconds": run.seconds}
    torch.save(state, path)


def load_actors(path: Path) -> list[PointerActor]:
    """The networks that `save_weights` wrote, in the order of their weights."""
    state = torch.load(path, weights_only=True)
    actors = [PointerActor(state["config"]["width"]) for _ in state["actors"]]
    for actor, weights in zip(actors, state["actors"], strict=True):
        actor.load_state_dict(weights)
    return actors


def main(arguments: list[str] | None = None) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m models.drl_moa", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of the run")
    add_options(parser, TransferConfig)
    options = parser.parse_args(arguments)
    saved = options.out / "run.pt"
    config = from_options(TransferConfig, options)
    train(resume(saved) if saved.exists() else new_run(config), options.out)


if __name__ == "__main__":
    main()
