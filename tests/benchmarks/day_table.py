"""The table of what the benchmark `day` has stored."""

import numpy as np

from tests.benchmarks.cells import of
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load

SIZES = (50, 100, 200, 500)
SHAPES = ("uniform", "clustered", "streets", "roads")
PROFILES = ("one peak", "two peaks", "tide")


def day_table() -> str:
    """Return the mean shares of each kind of instance, in per cent."""
    stored = load("day")
    head = ["stops", "shape", "profile", "instances", "1 s", "means, 1 s", "static, 1 s", "30 s"]
    rows = []
    for n in SIZES:
        for shape in SHAPES:
            for profile in PROFILES:
                if entries := of(stored.get(f"{n} stops, {shape}, {profile}")):
                    names = ("ours", "means", "static", "long")
                    means = [np.mean([each[name] for each in entries]) for name in names]
                    counted = [str(n), shape, profile, str(len(entries))]
                    rows.append([*counted, *(f"{mean:.2f}" for mean in means)])
    return table(head, rows)
