"""Round amounts up to numbers that people use."""

import math

from service.amounts.units import SECONDS

_QUARTER = 900  # seconds, in whole numbers of which times are changed


def rounded_up(amount: float) -> float:
    """Return a number of one digit that is at least an amount, as 4000 for 3120; at least 1."""
    if amount <= 1:
        return 1.0
    power = 10.0 ** math.floor(math.log10(amount))
    return math.ceil(amount / power) * power


def time_rounded_up(time: float, unit: str | None) -> float:
    """Return a time in whole quarters of an hour; in a unit that is no time, of one digit."""
    if unit not in SECONDS:
        return rounded_up(time)
    seconds = math.ceil(time * SECONDS[unit] / _QUARTER) * _QUARTER
    return seconds / SECONDS[unit]
