"""All that the compiled part of a search reads and changes."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import by_reference
from service.search.archive.layout import Archive
from service.search.costs import Costs
from service.search.working_tour import WorkingTour

Array = NDArray[np.float64]


class WeightedCandidates(NamedTuple):
    """Weights spread over all trade-offs, and the candidate lists under each of them."""

    weights: Array  # (k, m), rows adding to 1; of two objectives by ascending first weight
    candidates: NDArray[np.int32]  # (k, n, candidates)
    candidate_costs: Array  # (k, n, candidates)


@by_reference
class SearchState(NamedTuple):
    """The costs, the weights, the tours found, and the tour that two-opt changes."""

    costs: Costs
    weighted_candidates: WeightedCandidates
    archive: Archive
    working: WorkingTour
    random: NDArray[np.int64]  # (1,), the state of random_below()
