"""DRL-MOA, a rival: one network for each weighted sum, begun from the weights of the one before.

Li, Zhang and Wang (2020), arXiv:1906.02386. `python -m models.drl_moa --out runs/drl-moa` begins a
run, or resumes the one there; `weights.pt` holds the networks finished so far. Subproblems go from
the first length alone to the second alone, in equal steps of the weights.
"""

import argparse
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import torch
from jaxtyping import Float
from torch import Generator, Tensor
from torch.optim import Adam

from models.checkpoint import restore, state_of, write_whole
from models.data.instances import tour_lengths, uniform_cities
from models.networks.pointer_network import (
    PointerActor,
    PointerCritic,
    build_tours,
    log_likelihoods,
)
from models.options import add_options, differences, from_options, setting
from models.rollout import sampling
from models.steps import descend
from models.training_log import ProgressLog


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
    """The networks that are finished, and the one in training."""

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
        """The weights of the subproblem in training."""
        second = len(self.finished) / (self.config.subproblems - 1)
        return torch.tensor([1 - second, second])

    @property
    def steps(self) -> int:
        """The gradient steps of the subproblem in training."""
        return self.config.steps if self.finished else self.config.first_steps


_STATEFUL = ("actor", "critic", "optimizer", "critic_optimizer")


def new_run(config: TransferConfig) -> TransferRun:
    """Return a run at its beginning; everything random follows from the configuration's seed."""
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
    """Write the run."""
    state = state_of(run, _STATEFUL)
    write_whole(state | {"config": asdict(run.config), "finished": run.finished}, path)


def resume(path: Path) -> TransferRun:
    """Return the run that was saved at path."""
    state = torch.load(path, weights_only=True)
    run = new_run(TransferConfig(**state["config"]))
    restore(run, state, _STATEFUL)
    run.finished = state["finished"]
    return run


def train(run: TransferRun, out: Path) -> None:
    """Train the run to its end, writing to the folder out."""
    config = run.config
    left = (config.subproblems - len(run.finished)) * config.steps - run.step
    if not run.finished:
        left += config.first_steps - config.steps
    with ProgressLog(out, left, 0) as log:
        while len(run.finished) < config.subproblems:
            objective = take_step(run)
            log.advance(f"network {len(run.finished) + 1} objective {objective:.3f}")
            if run.step == run.steps:
                log.append(_line(run, objective))
                finish(run)
                save_weights(run, out / "weights.pt")
            if run.step % config.save_every == 0:
                save(run, out / "run.pt")


def take_step(run: TransferRun) -> float:
    """Take one step of the subproblem in training; return the mean objective of its tours."""
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
    descend(run.optimizer, run.actor, loss, config.clip_gradient)
    error = ((predicted - objectives) ** 2).mean()
    descend(run.critic_optimizer, run.critic, error, config.clip_gradient)
    run.step += 1
    run.seconds += time.perf_counter() - began
    return objectives.mean().item()


def finish(run: TransferRun) -> None:
    """Put the network in training among the finished ones; the next begins with its weights."""
    run.finished.append({name: x.clone() for name, x in run.actor.state_dict().items()})
    run.step = 0
    rate = run.config.learning_rate
    run.optimizer = Adam(run.actor.parameters(), lr=rate)
    run.critic_optimizer = Adam(run.critic.parameters(), lr=rate)


def _line(run: TransferRun, objective: float) -> dict[str, object]:
    return {
        "weight_1": f"{run.weights[0]:.4f}",
        "steps": run.step,
        "seconds": f"{run.seconds:.1f}",
        "objective": f"{objective:.4f}",
    }


def save_weights(run: TransferRun, path: Path) -> None:
    """Write the finished networks, their configuration and the seconds that they took.

    In half precision: there may be a hundred of them.
    """
    actors = [{name: x.half() for name, x in weights.items()} for weights in run.finished]
    state = {"config": asdict(run.config), "actors": actors, "seconds": run.seconds}
    write_whole(state, path)


def load_actors(path: Path) -> list[PointerActor]:
    """Return the networks that `save_weights` wrote, in the order of their weights."""
    state = torch.load(path, weights_only=True)
    actors = [PointerActor(state["config"]["width"]) for _ in state["actors"]]
    for actor, weights in zip(actors, state["actors"], strict=True):
        actor.load_state_dict(weights)
    return actors


def main(arguments: list[str] | None = None) -> None:
    """Run the command."""
    parser = argparse.ArgumentParser("python -m models.drl_moa", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of the run")
    add_options(parser, TransferConfig)
    options = parser.parse_args(arguments)
    saved = options.out / "run.pt"
    if not saved.exists():
        train(new_run(from_options(TransferConfig, options)), options.out)
        return
    run = resume(saved)
    if differing := differences(run.config, options):
        raise ValueError(
            f"the run in {options.out} must be resumed as it is, got {'; '.join(differing)}"
        )
    train(run, options.out)


if __name__ == "__main__":
    main()
