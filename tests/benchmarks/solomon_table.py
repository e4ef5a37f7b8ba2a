"""What is stored of Solomon's instances, as a table."""

import numpy as np

from tests.benchmarks.cells import of
from tests.benchmarks.fleet_table import OURS, PLAIN, in_their_box
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load


def section() -> str:
    """The section of the page of results; nothing before the first run."""
    if not load("solomon"):
        return ""
    return (
        "\n## Fleets with time windows\n\nNot in the paper: `python -m tests.benchmarks solomon`. "
        "Total distance against the longest route, the time on the\nway with service and waiting, "
        "on instances of Solomon's with 100 customers; in brackets by how much the\nleast distance "
        "exceeds the best known. Hypervolumes are in the box of both fronts.\n\n"
        f"{solomon_table()}"
    )


def solomon_table() -> str:
    """A row for each instance that both ways were measured on."""
    stored = load("solomon")
    rows = []
    for name in dict.fromkeys(key.partition(", ")[0] for key in stored):
        entries = [of(stored.get(f"{name}, {method}")) for method in (OURS, PLAIN)]
        if all(entries):
            ours, plain = (entry[0] for entry in entries)
            shares = in_their_box(ours["points"], plain["points"])
            best = ours["best_known"]
            rows.append(
                [name, f"{best:.1f}", *(_cells(each["points"], best) for each in (ours, plain))]
            )
            rows[-1] += [f"{100 * share:.1f} %" for share in shares]
            rows[-1].append(f"{ours['seconds']:.2f} s, {plain['seconds']:.2f} s")
    titles = ["", "best known distance", OURS, PLAIN, f"hypervolume, {OURS}", PLAIN, "in"]
    return table(titles, rows)


def _cells(points: list[list[float]], best: float) -> str:
    front = np.array(points)
    (least, _), (_, shortest) = front[front[:, 0].argmin()], front[front[:, 1].argmin()]
    excess = 100 * (least / best - 1)
    return (
        f"{len(front)} plans, distance from {least:.1f} ({excess:+.1f} %), "
        f"longest route from {shortest:.1f}"
    )
