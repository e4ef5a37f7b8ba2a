"""Say times of the day, durations and lengths with their units, as "10:00", "2:10 h", "14.2 km"."""

from service.amounts.units import DAY, HOUR, METRES, MINUTE, SECONDS

_FAR = 10_000  # metres, from which kilometres are said


def clock_time(time: float, unit: str | None) -> str | float:
    """Return a time of the day, as 8:05 or "day 2, 8:05"; the number in other units."""
    if unit not in SECONDS:
        return time
    minutes = round(time * SECONDS[unit] / MINUTE)
    days, minutes = divmod(minutes, DAY // MINUTE)
    text = f"{minutes // MINUTE}:{minutes % MINUTE:02}"
    return f"day {days + 1}, {text}" if days else text


def amount(value: float, unit: str | None) -> str:
    """Return a value with its unit, as "2:10 h", "12 min", "14.2 km" or "340 EUR"."""
    if unit in SECONDS:
        seconds = round(value * SECONDS[unit])
        minutes = round(seconds / MINUTE)
        if minutes >= MINUTE:
            return f"{minutes // MINUTE}:{minutes % MINUTE:02} h"
        return f"{minutes} min" if seconds >= MINUTE or not seconds else f"{seconds} s"
    if unit == "m" and value >= _FAR:
        return f"{value / METRES['km']:.4g} km"
    return f"{value:.6g}" + (f" {unit}" if unit else "")


def on_most_days(mean: float, most: float, unit: str | None) -> str:
    """Return the mean of a length that spreads, and what nine days of ten do not exceed."""
    return f"{amount(mean, unit)} on average; nine days of ten within {amount(most, unit)}"


def duration(time: float, unit: str | None) -> str:
    """Return a duration in words, as "45 min" or "1 h 30 min"; the number in other units."""
    if unit not in SECONDS:
        return f"{time:.16g}" + (f" {unit}" if unit else "")
    hours, minutes = divmod(round(time * SECONDS[unit] / MINUTE), HOUR // MINUTE)
    parts = [f"{hours} h"] * bool(hours) + [f"{minutes} min"] * bool(minutes or not hours)
    return " ".join(parts)
