"""Comparison of an ONNX file with the actor in torch: their tours must be the same."""

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from onnx import ModelProto
from torch import Generator, Tensor

from models.data.instances import uniform_cities
from models.data.preferences import fan_of_preferences
from models.networks.actor import Actor, StepwiseActor
from models.networks.pa_one import OneActor
from models.rollout import log_likelihoods_by_city
from models.rollout_repairs import repaired_tours
from service.onnx_runtime import onnxruntime

CITIES = (3, 7, 20, 40, 200, 1000)
PREFERENCES = (1, 20, 100)
REPAIRS = (0, 1, 10, 50)  # of tours of PA-One
_MANY_CITIES = 200  # above which torch takes minutes for more than one repair
# Logits this close are a tie: float32 sums of two orders differ by less, and either city may win.
_TIE = 1e-3
# PA-One joins by many comparisons at once; small changes to the cities show which were close.
_LEAST_ROUNDING, _ROUNDING_OF_A_CITY = 1e-6, 1e-8  # sums of more floats are less exact
_ROUNDINGS = 8  # times that cities are moved so


class TourMismatch(Exception):
    """The ONNX file and the actor build different tours."""


def session(model: ModelProto) -> onnxruntime.InferenceSession:
    """Return a session on the CPU."""
    return onnxruntime.InferenceSession(
        model.SerializeToString(), providers=["CPUExecutionProvider"]
    )


def onnx_tours(
    running: onnxruntime.InferenceSession, instance: Tensor, preferences: Tensor, repairs: int = 0
) -> NDArray[np.int64]:
    """Return the tours, shape (k, n), that the file builds of an instance, preferences (k, 2)."""
    names = [value.name for value in running.get_inputs()]
    inputs = {names[0]: instance.numpy(), "preferences": preferences.numpy()}
    if "repairs" in names:
        inputs["repairs"] = np.array(repairs, dtype=np.int64)
    tours: NDArray[np.int64] = running.run(["tours"], inputs)[0]
    return tours


def compare(
    actor: Actor,
    model: ModelProto,
    sizes: Sequence[int] = CITIES,
    counts: Sequence[int] = PREFERENCES,
    repairs: Sequence[int] = REPAIRS,
) -> None:
    """Build tours both ways, for all these numbers of cities and of preferences.

    Those of PA-One are repaired, for each of these numbers of repairs; above 200 cities once at
    most.

    Raises:
        TourMismatch: some tour differs, and not only after a tie; or a dimension of the graph's
            interface that should be dynamic is fixed.
    """
    _check_dimensions(model)
    running = session(model)
    for n in sizes:
        generator = Generator().manual_seed(n)
        instance = _instance(actor, n, generator)
        for k in counts:
            preferences = fan_of_preferences(k, torch.device("cpu"))
            for times in _numbers_of_repairs(actor, n, repairs):
                _compare_tours(actor, running, instance, preferences, times)


def _instance(actor: Actor, n: int, generator: Generator) -> Tensor:
    """Draw an instance as the actor reads it; matrices differ by direction."""
    if actor.reads == "matrices":
        return torch.rand(1, 2, n, n, generator=generator)
    return uniform_cities(1, n, generator, torch.device("cpu"))


def _numbers_of_repairs(actor: Actor, n: int, repairs: Sequence[int]) -> Sequence[int]:
    if not isinstance(actor, OneActor):
        return (0,)
    return [times for times in repairs if times <= 1 or n <= _MANY_CITIES]


def _compare_tours(
    actor: Actor,
    running: onnxruntime.InferenceSession,
    instance: Tensor,
    preferences: Tensor,
    repairs: int,
) -> None:
    expected = _torch_tours(actor, instance, preferences, repairs)
    tours = torch.from_numpy(onnx_tours(running, instance[0], preferences, repairs))
    if repairs > 0:
        tours = _from_the_first_city(tours)
    if torch.equal(tours, expected):
        return
    if isinstance(actor, StepwiseActor):
        _check_ties(actor, instance, preferences, (tours, expected))
    else:
        _check_rounding(actor, instance, preferences, repairs, (tours, expected))


def _from_the_first_city(tours: Tensor) -> Tensor:
    """Return the same closed tours, in the same direction, from city 0 on."""
    n = tours.shape[1]
    places = tours.argmin(dim=1, keepdim=True) + torch.arange(n)
    return tours.gather(1, places % n)


def _torch_tours(actor: Actor, instance: Tensor, preferences: Tensor, repairs: int) -> Tensor:
    """Return the tours that torch builds: repaired ones from city 0 on, as they begin anywhere."""
    if isinstance(actor, OneActor):
        tours = repaired_tours(actor, instance, preferences, repairs)[0][0]
        return _from_the_first_city(tours) if repairs > 0 else tours
    return actor.tours(instance, preferences)[0]


def _check_dimensions(model: ModelProto) -> None:
    expected = {
        "cities": ["n", 4],
        "matrices": [2, "n", "n"],
        "preferences": ["k", 2],
        "repairs": [],
        "tours": ["k", "n"],
        "visited": ["k", "n"],
    }
    for value in (*model.graph.input, *model.graph.output):
        shape = [d.dim_param or d.dim_value for d in value.type.tensor_type.shape.dim]
        if shape != expected[value.name]:
            raise TourMismatch(f"{value.name} must have shape {expected[value.name]}, got {shape}")


def _check_rounding(
    actor: Actor,
    instance: Tensor,
    preferences: Tensor,
    repairs: int,
    both: tuple[Tensor, Tensor],
) -> None:
    """Raise TourMismatch unless the tours that differ do so in torch when cities are rounded."""
    tours, expected = both
    robust = torch.ones(len(expected), dtype=torch.bool)
    rounding = max(_LEAST_ROUNDING, _ROUNDING_OF_A_CITY * tours.shape[1])
    generator = Generator().manual_seed(0)
    for _ in range(_ROUNDINGS):
        moved = instance * (1 + rounding * torch.randn(instance.shape, generator=generator))
        robust &= (_torch_tours(actor, moved, preferences, repairs) == expected).all(dim=1)
    differs = tours != expected
    for i in (differs.any(dim=1) & robust).nonzero().flatten().tolist():
        parting = int(differs[i].nonzero()[0])
        raise TourMismatch(
            f"tours of {tours.shape[1]} cities part at position {parting}, though cities may be "
            f"rounded by {rounding:g} of themselves in torch without a change"
        )


def _check_ties(
    actor: StepwiseActor, instance: Tensor, preferences: Tensor, both: tuple[Tensor, Tensor]
) -> None:
    """Raise TourMismatch unless torch finds both cities about as likely where two tours part."""
    rows, members, places = actor.grouped(preferences)
    with torch.no_grad():
        memory, conditioning = actor.remember(instance, rows), actor.decoder.condition(rows)
        likelihoods = [
            log_likelihoods_by_city(actor.decoder, memory, conditioning, tours[None, members])[
                0, places
            ]
            for tours in both
        ]
    differs = both[0] != both[1]
    for i in differs.any(dim=1).nonzero().flatten().tolist():
        parting = int(differs[i].nonzero()[0])
        # Tours from a given city have one choice fewer than cities.
        choice = parting - (differs.shape[1] - likelihoods[0].shape[1])
        gap = float((likelihoods[0][i, choice] - likelihoods[1][i, choice]).abs())
        if not gap <= _TIE:
            raise TourMismatch(
                f"tours of {differs.shape[1]} cities part at position {parting}, where "
                f"log-likelihoods must differ by at most {_TIE}, got {gap:g}"
            )
