"""What is stored of the time to a good front, as a table, and the exponent of its growth."""

import numpy as np
from numpy.typing import ArrayLike

from tests.benchmarks.cells import of
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load


def section() -> str:
    """The section of the page of results; nothing before the first run."""
    if not load("growth"):
        return ""
    return (
        "\nNot in the paper: `python -m tests.benchmarks growth`. Uniform cities, one thread: "
        "seconds until the hypervolume is\nwithin 1 % of that after the limit, in the box from "
        f"the least lengths to the greatest of the front there.\n\n{growth_table()}"
    )


def growth_table() -> str:
    """A row for each number of cities, and the exponent of the law that fits best."""
    entries = {key: of(entry)[0] for key, entry in load("growth").items()}
    rows = [
        [key, f"{entry['seconds']:.3g}", f"{entry['limit']:g}"] for key, entry in entries.items()
    ]
    if len(rows) > 1:
        cities = [int(key.partition(" ")[0]) for key in entries]
        growth = exponent(cities, [entry["seconds"] for entry in entries.values()])
        rows.append([f"seconds grow as cities^{growth:.2f}", "", ""])
    return table(["", "seconds to within 1 %", "limit, s"], rows)


def exponent(cities: ArrayLike, seconds: ArrayLike) -> float:
    """The exponent e of the law seconds ~ cities^e that fits best, by logarithms."""
    return float(np.polyfit(np.log(cities), np.log(seconds), 1)[0])
