"""Tables of times and comparisons in the guide, made of the stored results of benchmarks."""

from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks.congestion_table import congestion_table
from tests.benchmarks.day_table import day_table
from tests.benchmarks.markdown import table
from tests.benchmarks.optima_table import optima_table
from tests.benchmarks.provenance import load
from tests.benchmarks.roads import roads_table
from tests.benchmarks.scale_table import scale_table
from tests.benchmarks.weights_table import weights_table
from tests.guide.pages import GUIDE

NEAR = 0.1  # percentage points of hypervolume below the longest search
SIZES = (40, 200, 500, 1000, 2000, 5000)


def figures() -> dict[str, tuple[Path, str]]:
    """Return the page and the Markdown of each table, by its name."""
    limits, weights = GUIDE / "limits.md", GUIDE / "three-weights-in-or-tools.md"
    quality = GUIDE / "how-good-is-it.md"
    return {
        "weights": (weights, weights_table()),
        "times": (limits, times_table()),
        "scale": (quality, scale_table()),
        "road-times": (limits, roads_table(load("roads"))),
        "optima": (quality, optima_table()),
        "congestion": (quality, congestion_table()),
        "day": (GUIDE / "plan-around-the-rush-hour.md", day_table()),
    }


def times_table() -> str:
    """Return seconds and memory by the number of cities, and the processors of all of them."""
    networks, memory, search = load("networks"), load("large"), load("search")
    rows, processors = [], set()
    for n in SIZES:
        large = memory.get(f"{n} cities")
        network = networks.get(f"{n} PA-One") or large
        found = search.get(f"{n} Paretour")
        rows.append([str(n), _seconds(network), _megabytes(large), _soon(found)])
        processors |= {entry["cpu"] for entry in (large, network, found) if entry}
    made = table(["cities", "network alone", "its memory", "search"], rows)
    return f"{made}\nProcessor: {', '.join(sorted(processors))}.\n"


def _seconds(entry: dict[str, Any] | None) -> str:
    if entry is None:
        return ""
    return f"{np.mean([each['seconds'] for each in entry['instances']]):.2g} s"


def _megabytes(entry: dict[str, Any] | None) -> str:
    return f"{entry['instances'][0]['peak_mb']:.0f} MB" if entry else ""


def _soon(entry: dict[str, Any] | None) -> str:
    """The shortest time limit whose hypervolume, on average, is near that of the longest one."""
    if entry is None:
        return ""
    runs = entry["instances"]
    [corner, *_] = runs[0][0]["hypervolume"]
    shares = np.array([[mark["hypervolume"][corner] for mark in run] for run in runs]).mean(axis=0)
    soonest = int(np.argmax(shares >= shares[-1] - NEAR))
    return f"{runs[0][soonest]['limit']:g} s"
