"""A van's deliveries in a city: metres driven beside the risk of an accident."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STOPS = 60
SIZE = np.array([9000.0, 6500.0])  # of the city, in metres
# x, y and reach in metres, and the risk as a multiple of the usual one.
BLACK_SPOTS = np.array(
    [
        [4300.0, 3400.0, 700.0, 9.0],  # the ring road's junction
        [2500.0, 1900.0, 500.0, 6.0],  # the market
        [6800.0, 4700.0, 600.0, 7.0],  # the bridge
        [6100.0, 1500.0, 450.0, 5.0],  # the hill, icy in winter
    ]
)
USUAL = 2.0  # accidents per million kilometres, so per thousand million metres
THOUSAND = 1000


def deliveries() -> dict[str, Any]:
    """Return the request: the depot first, then the stops.

    Plane 1 is the map in metres. Plane 2 is the map redrawn so that the distance between two stops
    is the risk of driving from one to the other, in accidents per million drives.
    """
    rng = np.random.default_rng(8)
    stops = np.concatenate((SIZE[np.newaxis] * [0.08, 0.9], _stops(rng)))
    redrawn = _in_plane(_risks(stops)) / THOUSAND
    return {
        "coordinates": np.concatenate((stops.round(1), redrawn.round(4)), axis=1).tolist(),
        "time_limit": 1.0,
        "seed": 1,
    }


def _stops(rng: np.random.Generator) -> Array:
    """Return stops, shape (STOPS, 2): in seven neighbourhoods, and every fourth anywhere."""
    neighbourhoods = rng.uniform(0.12, 0.88, (7, 2)) * SIZE
    near = neighbourhoods[rng.integers(0, 7, STOPS)] + rng.normal(0, 600, (STOPS, 2))
    anywhere = rng.uniform(0, 1, (STOPS, 2)) * SIZE
    stops = np.where(np.arange(STOPS)[:, np.newaxis] % 4 == 0, anywhere, near)
    return stops.clip(0, SIZE)


def _risks(stops: Array) -> Array:
    """Return the risk along the straight line from each stop to each other, shape (n, n)."""
    share = np.linspace(0, 1, 101)[:, np.newaxis, np.newaxis, np.newaxis]
    along = (1 - share) * stops[:, np.newaxis] + share * stops
    risk = np.full(along.shape[:-1], USUAL)
    for x, y, reach, times in BLACK_SPOTS:
        squared = ((along - (x, y)) ** 2).sum(axis=-1)
        risk += USUAL * times * np.exp(-squared / (2 * reach**2))
    metres = np.linalg.norm(stops[:, np.newaxis] - stops, axis=-1)
    return risk.mean(axis=0) * metres


def _in_plane(distances: Array) -> Array:
    """Return points, shape (n, 2), of about these distances, by multidimensional scaling."""
    centred = distances**2
    centred = centred - centred.mean(axis=0) - centred.mean(axis=1, keepdims=True) + centred.mean()
    values, vectors = np.linalg.eigh(-centred / 2)
    points = vectors[:, -2:][:, ::-1] * np.sqrt(values[-2:][::-1])
    points *= np.where(points[0] < 0, -1, 1)  # an eigenvector may come out either way round
    return points - points.min(axis=0)
