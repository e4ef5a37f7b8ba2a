"""Whether an ONNX file does what the actor in torch does."""

import numpy as np
import onnxruntime
import torch
from numpy.typing import NDArray
from onnx import ModelProto
from torch import Generator, Tensor

from models.networks import Actor
from models.rollout import log_likelihoods_by_city
from models.sampling import fan_of_preferences, uniform_cities
from models.validation import greedy_tours

CITIES = (3, 7, 40, 200, 1000)
PREFERENCES = (1, 20, 100)
# Logits this close are a tie: float32 sums of two orders differ by less, and either city may win.
_TIE = 1e-3


class Mismatch(Exception):
    """The ONNX file and the actor build different tours."""


def session(model: ModelProto) -> onnxruntime.InferenceSession:
    """A session on the CPU."""
    return onnxruntime.InferenceSession(
        model.SerializeToString(), providers=["CPUExecutionProvider"]
    )


def onnx_tours(
    running: onnxruntime.InferenceSession, cities: Tensor, preferences: Tensor
) -> NDArray[np.int64]:
    """The tours, shape (k, n), of cities (n, 4) and preferences (k, 2)."""
    inputs = {"cities": cities.numpy(), "preferences": preferences.numpy()}
    tours: NDArray[np.int64] = running.run(["tours"], inputs)[0]
    return tours


def compare(actor: Actor, model: ModelProto) -> None:
    """Builds tours both ways for every number of cities and preferences above.

    Raises:
        Mismatch: some tour differs, and not from a tie on. A dimension of the graph's interface
            that should be dynamic is not.
    """
    _check_dimensions(model)
    running = session(model)
    for n in CITIES:
        cities = uniform_cities(1, n, Generator().manual_seed(n), torch.device("cpu"))
        for k in PREFERENCES:
            preferences = fan_of_preferences(k, torch.device("cpu"))
            expected = greedy_tours(actor, cities, preferences)[0]
            tours = torch.from_numpy(onnx_tours(running, cities[0], preferences))
            for i in (tours != expected).any(dim=1).nonzero().flatten():
                _check_tie(actor, cities, preferences[i : i + 1], tours[i], expected[i])


def _check_dimensions(model: ModelProto) -> None:
    expected = {"cities": ["n", 4], "preferences": ["k", 2], "tours": ["k", "n"]}
    for value in (*model.graph.input, *model.graph.output):
        shape = [d.dim_param or d.dim_value for d in value.type.tensor_type.shape.dim]
        if shape != expected[value.name]:
            raise Mismatch(f"{value.name} must have shape {expected[value.name]}, got {shape}")


def _check_tie(
    actor: Actor, cities: Tensor, preference: Tensor, tour: Tensor, expected: Tensor
) -> None:
    """Raises unless, where the tours part, torch finds both next cities all but equally likely."""
    if sorted(tour.tolist()) != list(range(len(tour))):
        raise Mismatch(f"{tour.tolist()} is not a tour")
    parting = int((tour != expected).nonzero()[0])
    memory, rows = actor.remember(cities), actor.decoder.condition(preference)
    with torch.no_grad():
        likelihoods = [
            log_likelihoods_by_city(actor, memory, rows, each[None, None])[0, 0]
            for each in (tour, expected)
        ]
    # Tours that follow given starts have one choice fewer than cities.
    choice = parting - (len(tour) - len(likelihoods[0]))
    difference = float((likelihoods[0][choice] - likelihoods[1][choice]).abs())
    if difference > _TIE:
        raise Mismatch(
            f"with {len(tour)} cities the tours part at position {parting}, where log-likelihoods "
            f"must differ by at most {_TIE}, got {difference:g}"
        )
