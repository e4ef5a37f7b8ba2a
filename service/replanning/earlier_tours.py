"""Earlier tours: the rest of each tour of an earlier front."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance

Tours = NDArray[np.int64]
MOST_TRIED = 2**25  # places of cities that are inserted, each in some ten nanoseconds


@dataclass(frozen=True, eq=False)
class EarlierTours:
    """What is left of the tours of an earlier front.

    Args:
        tours: The cities of an instance that were in the earlier front already, in the order of
            each of its tours, shape (m, k), m at least 1. The first is the tour being driven. All
            begin and end at the fixed ends of the instance, if it has any.
        min_kept: The least share of the driven tour's legs that a tour shall keep.
        touched: The cities beside which another has gone from one of the tours, or to or from which
            a cost has changed; None where that may be any.
        balance: Of the tour being driven, in the earlier front; None where it was not of that.
    """

    tours: Tours
    min_kept: float = 0.0
    touched: NDArray[np.int64] | None = None
    balance: float | None = None

    @property
    def driven(self) -> NDArray[np.int64]:
        """What is left of the tour being driven, shape (k,)."""
        return self.tours[0]


def few_enough(instance: Instance, earlier: EarlierTours, most: int = MOST_TRIED) -> EarlierTours:
    """Return the earlier tours, or fewer of them, so that to complete them takes at most a second.

    Those that stay are the one being driven, and others evenly spread.

    Args:
        instance: The instance.
        earlier: The earlier tours, shape (m, k).
        most: The most places, of all cities in all tours, that are tried to insert them.
    """
    m, k = earlier.tours.shape
    fitting = max(1, most // max(1, instance.n * (instance.n - k)))
    chosen = np.linspace(0, m - 1, min(m, fitting)).astype(np.intp)
    return replace(earlier, tours=earlier.tours[chosen])


def touched_cities(instance: Instance, earlier: EarlierTours, tours: Tours) -> NDArray[np.int64]:
    """Return the cities where the completed earlier tours may be improved at first, ascending.

    Those are the cities touched, the ones inserted, and those before and after these.
    """
    if earlier.touched is None:
        return np.arange(instance.n)
    inserted = ~np.isin(tours, earlier.driven)
    beside = inserted | np.roll(inserted, 1, axis=1) | np.roll(inserted, -1, axis=1)
    return np.union1d(earlier.touched, tours[beside])
