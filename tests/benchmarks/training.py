"""`python -m tests.benchmarks training`: how the released networks were trained.

Reads the checkpoints in `models/checkpoints` and stores what they say of themselves in
`results/training.json`. Their model cards tell the rest.
"""

import argparse
from pathlib import Path
from typing import Any

import torch

from models.checkpoint import load_weights
from tests.benchmarks.provenance import provenance, store

CHECKPOINTS = Path("models/checkpoints")


def main(arguments: list[str]) -> None:
    """The command line."""
    argparse.ArgumentParser("python -m tests.benchmarks training", description=__doc__).parse_args(
        arguments
    )
    rows = {path.stem: _row(path) for path in sorted(CHECKPOINTS.glob("*.pt"))}
    store("training", {**provenance(1), "rows": rows})


def _row(path: Path) -> dict[str, Any]:
    return _transferred(path) if path.stem == "drl-moa" else _trained(path)


def _trained(path: Path) -> dict[str, Any]:
    trained = load_weights(path)
    config = trained.config
    return {
        "objective": config.objective,
        "baseline": config.baseline,
        "instances": config.instances,
        "preferences": config.preferences,
        "starts": config.starts,
        "cities": _span(config.least_cities, config.most_cities),
        "steps": trained.step,
        "hours": round(trained.seconds / 3600, 2),
    }


def _transferred(path: Path) -> dict[str, Any]:
    state = torch.load(path, weights_only=True)
    config, networks = state["config"], len(state["actors"])
    return {
        "objective": "weighted-sum",
        "baseline": "critic",
        "instances": config["instances"],
        "preferences": networks,
        "starts": 1,
        "cities": str(config["cities"]),
        "steps": config["first_steps"] + (networks - 1) * config["steps"],
        "hours": round(state["seconds"] / 3600, 2),
    }


def _span(least: int, most: int) -> str:
    return str(least) if least == most else f"{least} to {most}"
