"""A van's deliveries in a city: metres driven beside the risk of an accident."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STOPS = 60
SIZE = np.array([9000.0, 6500.0])  # of the city, in metres
# Where the accidents happen: x and y in metres, reach in metres, how many times the usual risk.
BLACK_SPOTS = np.array(
    [
        [4300.0, 3400.0, 700.0, 9.0],  # the ring road's junction
        [2500.0, 1900.0, 500.0, 6.0],  # the market
        [6800.0, 4700.0, 600.0, 7.0],  # the bridge
        [6100.0, 1500.0, 450.0, 5.0],  # the hill, icy in winter
    ]
)
USUAL = 2.0  # accidents in a million kilometres


def deliveries() -> dict[str, Any]:
    """The request: the depot first, then the stops.

    Plane 1 is the map in metres. Plane 2 is the map redrawn so that what lies between two stops is
    the risk of driving from one to the other, in accidents in a thousand million drives.
    """
    rng = np.random.default_rng(8)
    stops = np.concatenate((SIZE[np.newaxis] * [0.08, 0.9], _stops(rng)))
    redrawn = _in_plane(_risks(stops))
    return {
        "coordinates": np.concatenate((stops, redrawn), axis=1).round(1).tolist(),
        "time_limit": 1.0,
        "seed": 1,
    }


def _stops(rng: np.random.Generator) -> Array:
    """Stops in seven neighbourhoods and, every fourth, anywhere, shape (STOPS, 2)."""
    neighbourhoods = rng.uniform(0.12, 0.88, (7, 2)) * SIZE
    near = neighbourhoods[rng.integers(0, 7, STOPS)] + rng.normal(0, 600, (STOPS, 2))
    anywhere = rng.uniform(0, 1, (STOPS, 2)) * SIZE
    stops = np.where(np.arange(STOPS)[:, np.newaxis] % 4 == 0, anywhere, near)
    return stops.clip(0, SIZE)


def _risks(stops: Array) -> Array:
    """The risk along the straight line from each stop to each other, shape (n, n)."""
    ways = np.linspace(0, 1, 101)[:, np.newaxis, np.newaxis, np.newaxis]
    along = (1 - ways) * stops[:, np.newaxis] + ways * stops
    risk = np.full(along.shape[:-1], USUAL)
    for x, y, reach, times in BLACK_SPOTS:
        squared = ((along - (x, y)) ** 2).sum(axis=-1)
        risk += USUAL * times * np.exp(-squared / (2 * reach**2))
    metres = np.linalg.norm(stops[:, np.newaxis] - stops, axis=-1)
    return risk.mean(axis=0) * metres


def _in_plane(distances: Array) -> Array:
    """Points whose distances come close to those given: classical multidimensional scaling."""
    centred = distances**2
    centred = centred - centred.mean(axis=0) - centred.mean(axis=1, keepdims=True) + centred.mean()
    values, vectors = np.linalg.eigh(-centred / 2)
    points = vectors[:, -2:][:, ::-1] * np.sqrt(values[-2:][::-1])
    points *= np.where(points[0] < 0, -1, 1)  # an eigenvector may come out either way round
    return points - points.min(axis=0)
