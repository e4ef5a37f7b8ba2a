"""Compile the search for three and four objectives, or load it from the cache."""

import numpy as np

from service.instance import Instance
from service.search.best_subset import best_subset
from service.search.bound.hypervolume import hypervolume_bound
from service.search.enumeration import exact_tours
from service.search.hypervolume import hypervolume
from service.search.improve import improve

_N = 12  # cities: too many to enumerate


def warm_up() -> None:
    """Compile it by searches that use all of it; what two objectives need as well is there."""
    cities = np.arange(float(_N))
    planes = np.stack([cities, cities**2 % 11, cities**2 % 7, cities, cities % 5, cities], axis=1)
    instance = Instance(coordinates=planes)
    matrices = np.triu(np.outer(cities, cities) % np.array([7.0, 5.0, 3.0]).reshape(3, 1, 1))
    for each in (instance, Instance(matrices=matrices)):
        found = improve(each, np.arange(_N)[np.newaxis], iterations=3_000, capacity=16)
        best_subset(found.points, 2, each.reference_point)
        hypervolume(found.points, each.reference_point)
        hypervolume_bound(each, each.reference_point)
    exact_tours(Instance(coordinates=planes[:5]))
    four = np.concatenate((planes, planes[:, :2]), axis=1)[:5]
    exact_tours(Instance(coordinates=four))
