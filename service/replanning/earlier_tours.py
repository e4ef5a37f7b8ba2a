"""Earlier tours: the rest of each tour of an earlier front."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance

Tours = NDArray[np.int64]
MOST_TRIED = 2**25  # places that are tried for new cities; each takes about ten nanoseconds


@dataclass(frozen=True, eq=False)
class EarlierTours:
    """The rest of the tours of an earlier front.

    Args:
        tours: The cities of an instance that were in the earlier front already, in the order of
            each of its tours, shape (m, k), m at least 1. The first is the tour being driven. All
            begin and end at the fixed ends of the instance, if it has any.
        min_kept: The least share of the driven tour's legs that a tour must keep.
        touched: The cities next to which a city was removed from a tour, and the cities to or from
            which a cost has changed; None if these may be any cities.
        balance: The balance of the driven tour in the earlier front; None if it was not one of its
            tours.
    """

    tours: Tours
    min_kept: float = 0.0
    touched: NDArray[np.int64] | None = None
    balance: float | None = None

    @property
    def driven(self) -> NDArray[np.int64]:
        """The rest of the tour being driven, shape (k,)."""
        return self.tours[0]


def few_enough(instance: Instance, earlier: EarlierTours, most: int = MOST_TRIED) -> EarlierTours:
    """Return the earlier tours, or as many of them as can be completed in at most a second.

    The driven tour stays, and others that are evenly spread.

    Args:
        earlier: The earlier tours, shape (m, k).
        most: The most places that are tried for new cities in all tours together.
    """
    m, k = earlier.tours.shape
    fitting = max(1, most // max(1, instance.n * (instance.n - k)))
    chosen = np.linspace(0, m - 1, min(m, fitting)).astype(np.intp)
    return replace(earlier, tours=earlier.tours[chosen])


def touched_cities(instance: Instance, earlier: EarlierTours, tours: Tours) -> NDArray[np.int64]:
    """Return the cities, ascending, at which the search first tries to improve completed tours.

    These are the touched cities, the inserted cities and the neighbours of the inserted cities.
    """
    if earlier.touched is None:
        return np.arange(instance.n)
    inserted = ~np.isin(tours, earlier.driven)
    beside = inserted | np.roll(inserted, 1, axis=1) | np.roll(inserted, -1, axis=1)
    return np.union1d(earlier.touched, tours[beside])
