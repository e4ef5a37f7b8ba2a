"""`python -m models.average --out MEAN.pt A.pt B.pt ...`: the mean of the weights of several runs.

Each of several runs from the same weights ends with noise of its own. Their mean has less noise,
and is as fast to use (Wortsman et al., 2022, arXiv:2203.05482).
"""

import argparse
from pathlib import Path

import torch

from models.checkpoint import Trained, load_weights, write


def average(trained: list[Trained]) -> Trained:
    """Return the mean of the weights; the configuration and steps of the last, the seconds of all.

    Raises:
        ValueError: a checkpoint is missing, or their networks differ.
    """
    networks = {checkpoint.config.network for checkpoint in trained}
    if len(networks) != 1:
        raise ValueError(f"checkpoints must be of one network, got {len(networks)}")
    states = [checkpoint.actor.state_dict() for checkpoint in trained]
    mean = {name: torch.stack([s[name] for s in states]).mean(dim=0) for name in states[0]}
    *_, last = trained
    last.actor.load_state_dict(mean)
    return last._replace(seconds=sum(checkpoint.seconds for checkpoint in trained))


def main(arguments: list[str] | None = None) -> None:
    """Run the command."""
    parser = argparse.ArgumentParser("python -m models.average", description=__doc__)
    parser.add_argument("checkpoints", type=Path, nargs="+", help="weights.pt of training runs")
    parser.add_argument("--out", type=Path, required=True, help="the checkpoint to write")
    options = parser.parse_args(arguments)
    write(average([load_weights(path) for path in options.checkpoints]), options.out)


if __name__ == "__main__":
    main()
