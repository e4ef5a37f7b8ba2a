"""`python -m export CHECKPOINT`: write a released checkpoint as one ONNX file.

The file is kept only if its greedy tours are those of the actor in torch.
"""

import argparse
import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import torch
from onnx import ModelProto, helper

from export import pa_one, stepwise
from export.check import compare, onnx_tours, session
from models.checkpoint import Trained, load_weights
from models.config import as_plain
from models.networks.actor import Actor
from models.validation import COUNTS, mean_hypervolume, validation_sets

# By the construction of an actor's tours.
_EXPORTERS: dict[str, Callable[[Any], ModelProto]] = {
    "stepwise": stepwise.to_onnx,
    "fragments": pa_one.to_onnx,
}


def to_onnx(actor: Actor) -> ModelProto:
    """Return the actor as one graph: an instance and preferences (k, 2) to tours (k, n).

    The instance is cities (n, 4) or matrices (2, n, n), as the actor reads it.
    """
    return _EXPORTERS[actor.construction](actor)


def main(arguments: list[str] | None = None) -> None:
    """Run the command."""
    parser = argparse.ArgumentParser("python -m export", description=__doc__)
    parser.add_argument("checkpoint", type=Path, help="weights.pt of a training run")
    parser.add_argument("--out", type=Path, help="default: service/actors/NAME.onnx")
    options = parser.parse_args(arguments)
    trained = load_weights(options.checkpoint)
    model = to_onnx(trained.actor)
    compare(trained.actor, model)
    describe(model, trained)
    out = options.out or Path("service/actors") / f"{trained.config.network.label}.onnx"
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_bytes(model.SerializeToString())
    print(f"{out}: tours equal torch's; hypervolume {_property(model, 'figures')}")


def describe(model: ModelProto, trained: Trained) -> None:
    """Add the metadata: name, configuration, origin, and the hypervolume that the file reaches."""
    config = trained.config
    helper.set_model_props(
        model,
        {
            "name": config.network.label,
            "inputs": trained.actor.reads,
            "config": json.dumps(as_plain(config)),
            "commit": _commit(),
            "steps": str(trained.step),
            "seconds": f"{trained.seconds:.0f}",
            "sizes": json.dumps([config.least_cities, config.most_cities]),
            "angles": json.dumps([0, 90]),
            "figures": json.dumps(_hypervolumes(model, trained.actor.reads)),
        },
    )


def _hypervolumes(model: ModelProto, reads: str) -> dict[str, float]:
    """Return the mean hypervolume by number of cities, reference point (n, n)."""
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
        for validation in validation_sets(reads, COUNTS, torch.device("cpu"))
    }


def _commit() -> str:
    described = subprocess.run(
        ["git", "describe", "--always", "--dirty"], capture_output=True, text=True, check=True
    )
    return described.stdout.strip()


def _property(model: ModelProto, key: str) -> str:
    return next(entry.value for entry in model.metadata_props if entry.key == key)


if __name__ == "__main__":
    main()
