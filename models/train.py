"""Training: `python -m models.train --out runs/one` begins a run, or resumes the one there.

Beside the checkpoint it writes the configuration, a log (CSV) and a curve (PNG). The actor learns
by policy gradient, with `--objective repairs` on repairs, or with `--objective imitation --labels
FOLDER` from the tours of `models.expert`.
"""

import argparse
import time
from pathlib import Path

import torch

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
from models.config import NetworkConfig, TrainingConfig
from models.data.dataset import Labels
from models.options import add_options, differences, from_options
from models.repair_steps import repair_step
from models.steps import StepMeans, imitation_step, policy_gradient_step
from models.training_log import TrainingLog
from models.validation import COUNTS, ValidationSet, mean_hypervolume, validation_sets


def train(
    run: Run,
    steps: int,
    validation: list[ValidationSet],
    out: Path,
    labels: Labels | None = None,
) -> None:
    """Train the run up to the given step, writing to the folder out.

    Raises:
        ValueError: labels lack for imitation, or are given for another objective.
    """
    if (labels is None) == (run.config.objective == "imitation"):
        raise ValueError("labels must be given for imitation, and for nothing else")
    with TrainingLog(out, run, steps) as log:
        while run.step < steps:
            began = time.perf_counter()
            log.stepped(_step(run, labels))
            run.seconds += time.perf_counter() - began
            if run.step % run.config.validate_every == 0 or run.step == steps:
                build = averaged_actor(run).eval().tours
                log.validated({v.cities: mean_hypervolume(build, v) for v in validation})
                save(run, out / "run.pt")
                save_weights(run, out / "weights.pt")


def _step(run: Run, labels: Labels | None) -> StepMeans:
    if labels is not None:
        return imitation_step(run, labels)
    return repair_step(run) if run.config.objective == "repairs" else policy_gradient_step(run)


def main(arguments: list[str] | None = None, counts: dict[int, int] = COUNTS) -> None:
    """Run the command; counts are of validation instances, by number of cities."""
    options = _parser().parse_args(arguments)
    device = torch.device(options.device)
    run = _begun_or_resumed(options, device)
    name = run.config.network.name
    if options.precision not in run.actor.precisions:
        precisions = " or ".join(run.actor.precisions)
        raise ValueError(f"{name} trains in {precisions}, got precision {options.precision}")
    run.precision = getattr(torch, options.precision)
    labels = Labels(options.labels) if options.labels else None
    validation = validation_sets(run.actor.reads, counts, device, run.config.objectives)
    train(run, run.config.steps, validation, options.out, labels)


def _begun_or_resumed(options: argparse.Namespace, device: torch.device) -> Run:
    saved = options.out / "run.pt"
    if saved.exists():
        run = resume(saved, device)
        _check_unchanged(run, options)
        return run
    network = from_options(NetworkConfig, options)
    run = new_run(from_options(TrainingConfig, options, network=network), device)
    if options.initial:
        start_from(run, load_weights(options.initial).actor)
    return run


def _check_unchanged(run: Run, options: argparse.Namespace) -> None:
    """Raise ValueError if options differ from those of the run that is to be resumed."""
    differing = [*differences(run.config.network, options), *differences(run.config, options)]
    if options.initial:
        differing.append(f"--initial {options.initial}, which has weights")
    if differing:
        raise ValueError(
            f"the run in {options.out} must be resumed as it is, got {'; '.join(differing)}"
        )


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
