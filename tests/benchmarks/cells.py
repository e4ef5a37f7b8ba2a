"""What stands in the cells of the page of results."""

from typing import Any

import numpy as np

MISSING = "not measured"


def of(entry: dict[str, Any] | None) -> list[Any]:
    """What was found of each instance."""
    return entry["instances"] if entry else []


def mean_share(values: list[float]) -> str:
    """The mean of shares in per cent, and their deviation."""
    if not values:
        return MISSING
    deviation = f" ± {np.std(values):.2f}" if len(values) > 1 else ""
    return f"{np.mean(values):.2f}{deviation}"


def mean_seconds(entry: dict[str, Any] | None) -> str:
    """The mean, with a star where others wanted the processor."""
    if not of(entry):
        return ""
    mean = np.mean([each["seconds"] for each in of(entry)])
    busy = entry is not None and entry.get("busy", 0) > 1
    return (f"{mean:.0f}" if mean >= 100 else f"{mean:.2g}") + ("\\*" if busy else "")


def share_in_seconds(entry: dict[str, Any] | None) -> str:
    """Both, of a row with one reference point."""
    found = mean_share([each["hypervolume"] for each in of(entry)])
    return f"{found} in {mean_seconds(entry)} s" if entry else found
