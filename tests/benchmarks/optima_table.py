"""The table of what the benchmark `optima` has stored."""

from typing import Any

import numpy as np

from tests.benchmarks.cells import of
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load

LIMITS = {15: 1.0, 20: 1.0, 25: 1.0, 30: 1.0, 35: 1.0, 40: 3.0}  # seconds, by stops
_LAST_DIGIT = 0.01  # of stated values: they are rounded


def section() -> str:
    """Return the section of the page of results."""
    return (
        "## Known optima over the day\n\n`python -m tests.benchmarks optima`: time-dependent "
        "instances of Adamo et al. (2019), 73 zones of speed,\nover HTTP. *Not reached*: by how "
        f"much the others are above.\n\n{optima_table()}"
    )


def optima_table() -> str:
    """Return how many known least durations are reached, by size."""
    stored = load("optima")
    head = ["stops", "time_limit", "instances", "reached", "less", "not reached", "answered in"]
    rows = []
    for n, limit in LIMITS.items():
        if entries := of(stored.get(f"{n} stops, {limit:g} s")):
            rows.append([str(n), f"{limit:g} s", str(len(entries)), *_row(entries)])
    return table(head, rows)


def _row(entries: list[dict[str, Any]]) -> list[str]:
    gaps = [each["found"] - each["known"] for each in entries]
    above = [
        f"{100 * gap / each['known']:.3f} %"
        for gap, each in zip(gaps, entries, strict=True)
        if gap > _LAST_DIGIT
    ]
    less = sum(gap < -_LAST_DIGIT for gap in gaps)
    seconds = np.mean([each["seconds"] for each in entries])
    reached = len(entries) - len(above)
    return [str(reached), str(less), ", ".join(above) or "none", f"{seconds:.2f} s"]
