"""Round amounts up to numbers that people use, and say how long something takes."""

import math

_SECONDS = {"s": 1, "second": 1, "seconds": 1, "min": 60, "minute": 60, "minutes": 60}
_SECONDS |= {"h": 3600, "hour": 3600, "hours": 3600}
_QUARTER = 900  # seconds, in whole numbers of which times are changed


def rounded_up(amount: float) -> float:
    """Return a number of one digit that is at least an amount, as 4000 for 3120; at least 1."""
    if amount <= 1:
        return 1.0
    power = 10.0 ** math.floor(math.log10(amount))
    return math.ceil(amount / power) * power


def time_rounded_up(time: float, unit: str | None) -> float:
    """Return a time in whole quarters of an hour; in a unit that is no time, of one digit."""
    if unit not in _SECONDS:
        return rounded_up(time)
    seconds = math.ceil(time * _SECONDS[unit] / _QUARTER) * _QUARTER
    return seconds / _SECONDS[unit]


def time_in_words(time: float, unit: str | None) -> str:
    """Return a time in words, as "45 min" or "1 h 30 min"."""
    if unit not in _SECONDS:
        return f"{time:.16g}" + (f" {unit}" if unit else "")
    hours, minutes = divmod(round(time * _SECONDS[unit] / 60), 60)
    parts = [f"{hours} h"] * bool(hours) + [f"{minutes} min"] * bool(minutes or not hours)
    return " ".join(parts)
