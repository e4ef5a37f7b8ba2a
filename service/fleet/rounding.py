"""Compare times and lengths, which are sums of floats: equal ones may differ by a rounding."""

ROUNDING = 1e-12  # relative: sums of a thousand terms in another order differ by less


def is_over(value: float, bound: float, reach: float = 0.0) -> bool:
    """Return whether a value exceeds a bound by more than a rounding.

    Every rule about times asks this function. So a vehicle that arrives when a window closes is in
    time, in whatever order its legs were added.

    Args:
        value: A sum that is not negative.
        bound: The most that is allowed.
        reach: The largest number from which the value was computed, if that is larger.
    """
    return min(value * (1 - ROUNDING), value - ROUNDING * reach) > bound


def excess(value: float, bound: float, reach: float = 0.0) -> float:
    """Return by how much a value exceeds a bound; 0 if it is a rounding."""
    return value - bound if value > bound and is_over(value, bound, reach) else 0.0
