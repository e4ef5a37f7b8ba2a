"""Read numbers, times, durations and budgets as people write them: "10:00", "2:10 h", "3%"."""

import re

from service.amounts.units import DAY, HOUR, METRES, MINUTE, SECONDS

# 10:00, 2:10 h, 10:00:30, and day 2, 8:05
_CLOCK = re.compile(r"(?:day (\d{1,3}), ?)?(\d{1,6}):([0-5]\d)(?::([0-5]\d))?(?: ?h)?")
_AMOUNT = re.compile(r"(\d+(?:\.\d+)?(?:e[+-]?\d+)?) ?([^\d\s].*)?")
_PER_CENT = re.compile(r"(\d+(?:\.\d+)?) ?%")


def number_in(text: str, unit: str | None) -> float:
    """Return the number, in a unit, that a text says, as 10:00, "2:10 h", "90 min" or "12 km".

    Raises:
        ValueError: The text says none, or the unit is of another kind.
    """
    if found := _CLOCK.fullmatch(text.strip()):
        hours, minutes, seconds = (int(part or 0) for part in found.group(2, 3, 4))
        days = int(found[1] or 1) - 1
        value, given = float(DAY * days + HOUR * hours + MINUTE * minutes + seconds), "s"
    elif found := _AMOUNT.fullmatch(text.strip()):
        value, given = float(found[1]), (found[2] or unit or "")
    else:
        raise ValueError(f"{text!r:.80} must be a number, a time as 10:00 or a duration as 2:10 h")
    sizes = next((each for each in (SECONDS, METRES) if given in each), {given: 1})
    if (unit or "") not in sizes:
        known = "no unit" if unit is None else f"the unit {unit}"
        raise ValueError(f"{text!r:.80} must be in the unit of its objective, which has {known}")
    return value * sizes[given] / sizes[unit or ""]


def budget_in(budget: float | str, least: float, unit: str | None) -> float:
    """Return the most that a budget allows; "3%" is so much more than the least.

    Raises:
        ValueError: As of `number_in`.
    """
    if not isinstance(budget, str):
        return budget
    if found := _PER_CENT.fullmatch(budget.strip()):
        return least * (1 + float(found[1]) / 100)
    return number_in(budget, unit)
