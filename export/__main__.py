"""`python -m export CHECKPOINT`: write a trained actor as one ONNX file, with its card.

The file is written only if its greedy tours are those of the actor in torch. The command prints
each step when it begins, with the seconds since the start.
"""

import argparse
import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import torch
from onnx import ModelProto, helper

from export import pa_one, stepwise
from export.card import card
from export.check import compare, onnx_tours, session
from export.progress import Progress
from models.checkpoint import Trained, load_weights
from models.config import as_plain
from models.networks.actor import Actor
from models.validation import COUNTS, mean_hypervolume, validation_sets

RELEASED = Path(__file__).parents[1] / "service/actors"
OWN_ACTORS = Path("runs/actors")
_UNKNOWN = "version unknown"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")

# By the construction of an actor's tours.
_EXPORTERS: dict[str, Callable[[Any], ModelProto]] = {
    "stepwise": stepwise.to_onnx,
    "fragments": pa_one.to_onnx,
}


def to_onnx(actor: Actor) -> ModelProto:
    """Return the actor as one graph: an instance and preferences (k, m) to tours (k, n).

    The instance is cities (n, 2m) or matrices (m, n, n), as the actor reads it; m is 2 but for
    PA-One.
    """
    return _EXPORTERS[actor.construction](actor)


def main(arguments: list[str] | None = None) -> None:
    """Run the command."""
    parser = argparse.ArgumentParser("python -m export", description=__doc__)
    parser.add_argument("checkpoint", type=Path, help="weights.pt of a training run")
    parser.add_argument("--name", help="of the actor, as requests ask for it")
    parser.add_argument("--out", type=Path, help="default: runs/actors/NAME.onnx")
    parser.add_argument(
        "--replace", action="store_true", help="write over a file, or take a released actor's name"
    )
    parser.add_argument("--yes", action="store_true", help="begin without asking")
    options = parser.parse_args(arguments)
    progress = Progress()
    progress.begin(f"reading {options.checkpoint}")
    trained = load_weights(options.checkpoint)
    name = options.name or trained.config.network.label
    out = options.out or OWN_ACTORS / f"{name}.onnx"
    if refusal := _refusal(name, out, options.replace):
        parser.error(refusal)
    _ask(options.yes)
    progress.begin(f"tracing a {trained.config.network.label} network of {trained.step} steps")
    model = to_onnx(trained.actor)
    progress.begin("comparing the graph's tours with PyTorch's")
    comparison = compare(trained.actor, model, report=progress.detail)
    progress.begin(f"{comparison}; measuring the hypervolume on validation instances")
    describe(model, trained, name)
    out.parent.mkdir(parents=True, exist_ok=True)
    content = model.SerializeToString()
    progress.begin(f"writing {_described(out, len(content))}")
    out.write_bytes(content)
    metadata = {entry.key: entry.value for entry in model.metadata_props}
    out.with_suffix(".md").write_text(
        card(name, str(options.checkpoint), trained, metadata), encoding="utf-8"
    )
    progress.begin(f"done: hypervolume {metadata['figures']} by number of cities")


def _described(out: Path, size: int) -> str:
    return f"{out}, {size / 1000:.0f} kB, and {out.with_suffix('.md').name}"


def _ask(agreed: bool) -> None:
    """Ask somebody at a terminal whether to begin, and end the command unless the answer is yes."""
    if agreed or not sys.stdin.isatty():
        return
    answer = input("This takes about three minutes. Begin? [y/N] ")
    if answer.strip().lower() not in ("y", "yes"):
        sys.exit("nothing was written")


def _refusal(name: str, out: Path, replace: bool) -> str | None:
    """Return why an actor of this name must not be written into this file, or None."""
    if not _NAME.fullmatch(name):
        return f"--name must be 1 to 64 letters, digits, dots, - and _, got {name!r}"
    if replace:
        return None
    if (RELEASED / f"{name}.onnx").exists():
        return f"{name} is a released actor: give another --name, or --replace"
    taken = [path for path in (out, out.with_suffix(".md")) if path.exists()]
    return f"{taken[0]} exists: give another --name or --out, or --replace" if taken else None


def describe(model: ModelProto, trained: Trained, name: str) -> None:
    """Add the metadata: name, configuration, origin, and the hypervolume that the file reaches."""
    config = trained.config
    helper.set_model_props(
        model,
        {
            "name": name,
            "inputs": trained.actor.reads,
            "config": json.dumps(as_plain(config)),
            "commit": _commit(),
            "steps": str(trained.step),
            "seconds": f"{trained.seconds:.0f}",
            "sizes": json.dumps([config.least_cities, config.most_cities]),
            "angles": json.dumps([0, 90]),
            "objectives": str(trained.actor.most_objectives),
            "figures": json.dumps(_hypervolumes(model, trained)),
        },
    )


def _hypervolumes(model: ModelProto, trained: Trained) -> dict[str, float]:
    """Return the mean hypervolume by number of cities, reference point (n, n, ...).

    It is that under as many objectives as the actor was trained with.
    """
    reads, objectives = trained.actor.reads, trained.config.objectives
    running = session(model)
    return {
        str(validation.cities): round(
            mean_hypervolume(
                lambda instances, preferences: torch.from_numpy(
                    onnx_tours(running, instances[0], preferences)
                )[None],
                validation,
            ),
            5,
        )
        for validation in validation_sets(reads, COUNTS, torch.device("cpu"), objectives)
    }


def _commit() -> str:
    """Return the version of the code that exports, if it lies in a repository of git."""
    try:
        described = subprocess.run(
            ["git", "describe", "--always", "--dirty"],
            capture_output=True,
            text=True,
            check=True,
            encoding="utf-8",
        )
    except (OSError, subprocess.CalledProcessError):
        return _UNKNOWN
    return described.stdout.strip()


if __name__ == "__main__":
    main()
