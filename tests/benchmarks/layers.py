"""`python -m tests.benchmarks layers CHECKPOINT ...`: the ablation of the preference layer.

Each checkpoint is a `weights.pt` of `models.train`, of a network with or without its preference
layer; without it a row is the network's name and a minus. Greedy tours for 100 preferences, in
PyTorch, on the paper's instances. Stores `results/layers.json`, instance by instance; what is
stored of the same checkpoint is not measured again.
"""

import argparse
from functools import partial
from hashlib import sha256
from pathlib import Path

import torch

from models.checkpoint import Trained, load_weights
from service.instance import Instance, tour_lengths
from service.preferences import fan, from_angles
from tests.benchmarks.instances import COUNT, SIZES, check_tours, paper_instances
from tests.benchmarks.rows import TOURS, Method, Points, measured, resume
from tests.benchmarks.training import CHECKPOINTS


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks layers", description=__doc__)
    parser.add_argument("checkpoints", type=Path, nargs="*", help="default: those released")
    parser.add_argument("--cities", type=int, nargs="+", choices=SIZES, default=SIZES)
    parser.add_argument("--count", type=int, default=COUNT, help="instances of each size")
    options = parser.parse_args(arguments)
    torch.set_num_threads(1)
    for path in options.checkpoints or sorted(CHECKPOINTS.glob("pa-[ae]*.pt")):
        trained = load_weights(path)
        method = Method(partial(_points, trained), digest=sha256(path.read_bytes()).hexdigest())
        for n in options.cities:
            instances = [Instance(coordinates=x) for x in paper_instances(n, options.count)]
            key = f"{n} {row_name(trained)}"
            resume("layers", key, method.digest, instances, partial(measured, method))


def row_name(trained: Trained) -> str:
    """As the paper writes it, PA-AT or PA-AT-."""
    network = trained.config.network
    return network.name.upper() + ("" if network.preference_layers else "-")


def _points(trained: Trained, instance: Instance) -> Points:
    cities = torch.from_numpy(instance.scaled_coordinates).float()[None]
    preferences = torch.from_numpy(from_angles(fan(TOURS))).float()
    tours = trained.actor.tours(cities, preferences)[0].numpy()
    check_tours(tours, instance.n)
    return tour_lengths(instance, tours)
