"""Construct a tour: by nearest neighbours, or of thousands of cities by greedy edge."""

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.search.candidates import Scalarization
from service.search.closing import with_end_last
from service.search.starts.greedy_edge import greedy_edge
from service.search.starts.nearest_neighbour import nearest_neighbour


def constructed_tour(
    instance: Instance, scalarization: Scalarization, greedy: bool = False
) -> NDArray[np.int32]:
    """Return a tour of an instance, as the closed one that is searched.

    Args:
        instance: The instance.
        scalarization: The weighted sum under which it is constructed.
        greedy: Whether by greedy edge, for which costs are symmetric and candidates ranked.
    """
    construct = greedy_edge if greedy else nearest_neighbour
    tour = np.zeros(len(scalarization.costs.cities), np.int32)
    if instance.closed:
        construct(scalarization, 1, tour)
        return tour
    tour[1] = 1 + (instance.start or 0)
    construct(scalarization, 2, tour)
    return with_end_last(instance, tour)
