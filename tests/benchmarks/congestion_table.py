"""The table of what the benchmark `congestion` has stored."""

import numpy as np

from tests.benchmarks.cells import mean_seconds, of
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load

_REACHED = 0.01  # per cent


def section() -> str:
    """Return the section of the page of results."""
    return (
        "## Fleets over the day\n\n`python -m tests.benchmarks congestion`: sets of ANR-MAMUT with "
        "arrival times of each pair of stops,\nthe sum of the durations of all routes beside the "
        f"best known one, 10 s on one thread.\n\n{congestion_table()}"
    )


def congestion_table() -> str:
    """Return how far the least sums of durations are above the best known, by set and size."""
    stored = load("congestion")
    head = ["instances", "of them", "above the best known", "worst", "reached", "less", "seconds"]
    rows = []
    for key in sorted(stored):
        entries = of(stored[key])
        gaps = np.array([100 * (each["found"] / each["known"] - 1) for each in entries])
        if len(gaps):
            shares = [f"{gaps.mean():.2f} %", f"{gaps.max():.2f} %"]
            reached, less = (gaps <= _REACHED).sum(), (gaps < -_REACHED).sum()
            seconds = mean_seconds(stored[key])
            rows.append([key, str(len(gaps)), *shares, str(reached), str(less), seconds])
    return table(head, rows)
