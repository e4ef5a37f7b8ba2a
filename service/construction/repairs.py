"""Repairs of first tours: how many are worth their time where a request does not say."""

from service.instance import Kind

TOURS_REPAIRED = 2  # for each preference: the tour, and one that was visited on the way

# The least number, and the cities for each one more. So a call takes two to three times as long as
# without, and has most of what repairs gain: `python -m tests.benchmarks literature`, `asymmetric`.
_WORTH: dict[Kind, tuple[int, int]] = {"coordinates": (3, 8), "matrices": (2, 16)}


def repairs_worth(inputs: Kind, n: int) -> int:
    """Return how many repairs of tours of n cities are worth their time.

    Args:
        inputs: The kind of instance that the network reads.
        n: The number of cities.
    """
    least, cities = _WORTH[inputs]
    return max(least, n // cities)
