"""Fronts as JSON."""

import time

import numpy as np

from service.jobs.front_document import rendered
from service.planner import Front


def test_a_hundred_tours_of_a_thousand_cities_serialise_in_50_ms() -> None:
    rng = np.random.default_rng(0)
    front = Front(
        tours=np.array([rng.permutation(1000) for _ in range(100)]),
        points=np.sort(rng.random((100, 2)), axis=0) * [1, -1] + [0, 2],
        found=100,
        scale=np.ones(2),
        reference_point=np.array([1000.0, 1000.0]),
        terminated="converged",
        timings={"construction": 1.0},
    )
    best = min(seconds_to_serialise(front) for _ in range(5))
    assert best < 0.05


def seconds_to_serialise(front: Front) -> float:
    began = time.perf_counter()
    rendered(front).json(id="id")
    return time.perf_counter() - began
