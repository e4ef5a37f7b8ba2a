"""Comparison of an ONNX file with the actor in torch: their tours must be the same."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import torch
from numpy.typing import NDArray
from onnx import ModelProto
from torch import Generator, Tensor

from models.data.instances import tour_lengths, uniform_cities
from models.data.preferences import fan_or_lattice
from models.networks.actor import Actor
from models.rollout_repairs import from_the_first_city
from service.onnx_runtime import onnxruntime

CITIES = (3, 7, 20, 40, 200, 1000)
PREFERENCES = (1, 20, 100)
REPAIRS = (0, 1, 10, 50)  # of tours of PA-One
_LEAST_LENGTH = 1e-9  # shorter than any tour: differences are divided by lengths
_MANY_CITIES = 200  # above which torch takes minutes for more than one repair


class TourMismatch(Exception):
    """The ONNX file and the actor build different tours."""


@dataclass(frozen=True)
class Comparison:
    """The result of comparing tours of the file with those of torch.

    Attributes:
        tours: The number of tours compared.
        ties: The number of tours that differ, but only after a tie.
        largest: The largest difference between the lengths of such a tour in the file and in torch,
            as a share of torch's length.
    """

    tours: int = 0
    ties: int = 0
    largest: float = 0.0

    def __add__(self, other: "Comparison") -> "Comparison":
        """Return the comparison of all tours of both."""
        return Comparison(
            self.tours + other.tours, self.ties + other.ties, max(self.largest, other.largest)
        )

    def __str__(self) -> str:
        if not self.ties:
            return f"all {self.tours} tours are the same"
        return (
            f"{self.tours - self.ties} of {self.tours} tours are the same, and {self.ties} part "
            f"after a tie: their lengths differ by at most {100 * self.largest:.2g} %"
        )


def session(model: ModelProto) -> onnxruntime.InferenceSession:
    """Return a session on the CPU."""
    return onnxruntime.InferenceSession(
        model.SerializeToString(), providers=["CPUExecutionProvider"]
    )


def onnx_tours(
    running: onnxruntime.InferenceSession, instance: Tensor, preferences: Tensor, repairs: int = 0
) -> NDArray[np.int64]:
    """Return the tours, shape (k, n), that the file builds of an instance, preferences (k, m)."""
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
    report: Callable[[str], None] = lambda _: None,
) -> Comparison:
    """Build tours both ways, for all these numbers of cities and of preferences.

    They are built under two objectives, then under each greater number that the actor takes. Those
    of PA-One are repaired, for each of these numbers of repairs; above 200 cities once at most.
    A line is reported before each instance.

    Raises:
        TourMismatch: some tour differs, and not only after a tie; or a dimension of the graph's
            interface that should be dynamic is fixed.
    """
    _check_dimensions(model, actor)
    running = session(model)
    comparison = Comparison()
    for m, n in product(range(2, actor.most_objectives + 1), sizes):
        generator = Generator().manual_seed(n)
        instance = _instance(actor, n, generator, m)
        report(f"{n} cities, {m} objectives")
        for k in counts:
            preferences = fan_or_lattice(k, m, torch.device("cpu"))
            for times in _numbers_of_repairs(actor, n, repairs):
                comparison += _compare_tours(actor, running, instance, preferences, times)
    return comparison


def _instance(actor: Actor, n: int, generator: Generator, objectives: int) -> Tensor:
    """Draw an instance as the actor reads it; matrices differ by direction."""
    if actor.reads == "matrices":
        return torch.rand(1, objectives, n, n, generator=generator)
    return uniform_cities(1, n, generator, torch.device("cpu"), objectives)


def _numbers_of_repairs(actor: Actor, n: int, repairs: Sequence[int]) -> Sequence[int]:
    if not actor.repairs_tours:
        return (0,)
    return [times for times in repairs if times <= 1 or n <= _MANY_CITIES]


def _compare_tours(
    actor: Actor,
    running: onnxruntime.InferenceSession,
    instance: Tensor,
    preferences: Tensor,
    repairs: int,
) -> Comparison:
    expected = actor.repaired_tours(instance, preferences, repairs)[0][0]
    tours = torch.from_numpy(onnx_tours(running, instance[0], preferences, repairs))
    if repairs > 0:  # such tours begin anywhere
        tours, expected = from_the_first_city(tours), from_the_first_city(expected)
    if torch.equal(tours, expected):
        return Comparison(len(tours))
    ties = actor.are_ties(instance, preferences, repairs, (tours, expected))
    for i in (~ties).nonzero().flatten().tolist():
        parting = int((tours[i] != expected[i]).nonzero()[0])
        raise TourMismatch(
            f"tours of {tours.shape[1]} cities part at position {parting}, and rounding alone "
            "cannot be why"
        )
    parted = (tours != expected).any(dim=1)
    ours, theirs = (tour_lengths(instance, each[None, parted]) for each in (tours, expected))
    differences = (ours - theirs).abs() / theirs.clamp(min=_LEAST_LENGTH)
    return Comparison(len(tours), int(parted.sum()), float(differences.max()))


def _check_dimensions(model: ModelProto, actor: Actor) -> None:
    is_of_two = actor.most_objectives == 2
    expected = {
        "cities": ["n", 4 if is_of_two else "x"],
        "matrices": [2 if is_of_two else "m", "n", "n"],
        "preferences": ["k", 2 if is_of_two else "m"],
        "repairs": [],
        "tours": ["k", "n"],
        "visited": ["k", "n"],
    }
    for value in (*model.graph.input, *model.graph.output):
        shape = [d.dim_param or d.dim_value for d in value.type.tensor_type.shape.dim]
        if shape != expected[value.name]:
            raise TourMismatch(f"{value.name} must have shape {expected[value.name]}, got {shape}")
