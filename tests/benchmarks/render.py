"""Render `tests/benchmarks/RESULTS.md` from the stored results and the paper's printed ones.

All figures of ours come from `results/*.json`, the printed ones from `printed.py`.
"""

from typing import Any

import numpy as np

from tests.benchmarks import (
    beyond,
    congestion_table,
    open_routes,
    optima_table,
    printed,
    roads,
    under_load,
)
from tests.benchmarks.cells import mean_seconds, mean_share, of, share_in_seconds
from tests.benchmarks.instances import SIZES, reference_points
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load

PLACES = (40, 100, 200)
ROWS = (
    *("NSGA-II (20K)", "NSGA-II (80K)", "MOEA/D (20K)", "MOEA/D (80K)"),
    *("DRL-MOA", "PA-EAN", "PA-AT", "PA-One"),
    *("OR-Tools (no limit)", "OR-Tools (n_l = 10)", "OR-Tools (n_l = 100)"),
    *("Nearest neighbour", "Greedy edge"),
)
INTRODUCTION = f"""# Results

The tables of the paper (Mehta, Taghipour and Saeedi, arXiv:2203.01298) with our figures beside the
printed ones, better or worse. Hypervolume is in per cent, exact, with the number of cities on
either axis as the reference point unless another is named: mean and deviation over the instances,
which are the paper's own. Methods give 100 tours, one for each preference or weight; the
evolutionary ones give their front, and Paretour's search as many tours as its row says.

Printed seconds: {printed.HARDWARE}.
Ours are of the processor, on one thread of the machines named below the table; a star marks those
taken while other programs wanted the same processor, which makes them too long.

`python -m tests.benchmarks NAME` prints the stored rows, and `NAME --again` measures them anew.
`python -m tests.benchmarks tables --store` measures what is missing and writes this page.
"""


def page() -> str:
    """Return the whole page as Markdown."""
    paper = (_main(), _training(), _coverage(), _layers(), _concave(), _fronts())
    over_the_day = (optima_table.section(), congestion_table.section())
    ours = (open_routes.section(), roads.section(), *over_the_day)
    return "\n".join((INTRODUCTION, *paper, beyond.section(), *ours, under_load.section()))


def _main() -> str:
    stored = _with_search(load("networks"))
    parts = ["## Hypervolume and time\n\n`python -m tests.benchmarks networks`\n"]
    for column, n in enumerate(SIZES):
        corners = list(reference_points(n))[::-1]  # the paper's first
        head = ["method", *(f"ours at {corner}" for corner in corners)]
        head[1:1] = ["printed"]
        rows = [_main_row(stored, n, column, row, corners) for row in ROWS]
        rows += [_search_row(stored, row, corners) for row in stored if row.startswith(f"{n} Pare")]
        head += ["seconds, printed", "seconds, ours", "instances"]
        parts.append(f"### {n} cities\n\n{table(head, rows)}")
    parts.append(_origins(stored))
    parts.append(_below(stored))
    return "\n".join(parts)


def _main_row(
    stored: dict[str, Any], n: int, column: int, row: str, corners: list[str]
) -> list[str]:
    shares, times = printed.HYPERVOLUME.get(row), printed.SECONDS.get(row)
    entry = stored.get(f"{n} {row}")
    return [
        row,
        str(shares[column]) if shares else "",
        *(mean_share([each["hypervolume"][corner] for each in of(entry)]) for corner in corners),
        str(times[column]) if times else "",
        mean_seconds(entry),
        str(len(of(entry))) if entry else "",
    ]


def _search_row(stored: dict[str, Any], key: str, corners: list[str]) -> list[str]:
    runs = of(stored[key])
    cells = [mean_share([run["hypervolume"][corner] for run in runs]) for corner in corners]
    points = f"{np.mean([run['points'] for run in runs]):.0f} tours"
    row = f"Paretour's search, {points}"
    return [row, "", *cells, "", mean_seconds(stored[key]), str(len(runs))]


def _with_search(stored: dict[str, Any]) -> dict[str, Any]:
    """Add the rows of `search`: Paretour's shortest and longest runs, OR-Tools on more instances.

    Its seconds are by the clock on the wall, and OR-Tools shared its core.
    """
    found = load("search")
    for n in SIZES:
        for limit in ("no limit", "n_l = 10"):
            entry = found.get(f"{n} OR-Tools, {limit}")
            if len(of(entry)) > len(of(stored.get(f"{n} OR-Tools ({limit})"))):
                stored[f"{n} OR-Tools ({limit})"] = _only(entry, 0) | {"busy": 2}
        if entry := found.get(f"{n} Paretour"):
            stored |= {f"{n} Paretour {i}": _only(entry, i) for i in (0, -1)}
    return stored


def _only(entry: dict[str, Any], mark: int) -> dict[str, Any]:
    return entry | {"instances": [rows[mark] for rows in entry["instances"]]}


def _origins(stored: dict[str, Any]) -> str:
    """Return the machines and commits that the rows were measured on."""
    entries = [entry for entry in stored.values() if of(entry)]
    machines = sorted({f"{entry['cpu']}, {entry['date']}" for entry in entries})
    commits = sorted({f"`{entry['commit']}`" for entry in entries})
    return f"Measured on: {'; '.join(machines)}. Commits: {', '.join(commits)}.\n"


def _below(stored: dict[str, Any]) -> str:
    """Return the rows whose hypervolume is below the printed one."""
    found = []
    for row, shares in printed.HYPERVOLUME.items():
        for n, share in zip(SIZES, shares, strict=True):
            corner = list(reference_points(n))[-1]
            values = [each["hypervolume"][corner] for each in of(stored.get(f"{n} {row}"))]
            if values and np.mean(values) < share:
                found.append(f"{row} at {n} cities by {share - np.mean(values):.2f}")
    return f"Below the printed hypervolume: {', '.join(found) or 'nothing'}.\n"


def _training() -> str:
    stored = load("training").get("rows", {})
    head = ["network", "instances a step", "epochs", "steps an epoch", "cities", "hours"]
    theirs = table(head, [[row, *cells] for row, cells in printed.TRAINING.items()])
    names = list(next(iter(stored.values()), {}))
    ours = table(
        ["checkpoint", *names],
        [[name, *(str(row[key]) for key in names)] for name, row in stored.items()],
    )
    return (
        "## Training\n\nPrinted, each network with 20 preferences, on one NVIDIA V100:\n\n"
        f"{theirs}\nOurs, `python -m tests.benchmarks training`; a step's tours are its instances "
        "times its\npreferences times its starts. The model cards in `models/checkpoints` name "
        f"the stages before\nthe last, and the hardware:\n\n{ours}"
    )


def _coverage() -> str:
    stored = load("coverage")
    ours = dict.fromkeys(key.partition(": ")[2] for key in stored)
    head = ["method", *(f"{n} places" for n in PLACES)]
    theirs = [
        [row, *(f"{share} in {seconds} s" for share, seconds in zip(shares, times, strict=True))]
        for row, shares in printed.COVERAGE_HYPERVOLUME.items()
        for times in [printed.COVERAGE_SECONDS[row]]
    ]
    cells = [
        [row, *(share_in_seconds(stored.get(f"{n} places: {row}")) for n in PLACES)] for row in ours
    ]
    return (
        f"## Coverage planning\n\nPrinted:\n\n{table(head, theirs)}\nOurs, `python -m "
        "tests.benchmarks coverage`: maps of our own and a reference point of n times the\n"
        "scale, for the paper names neither, so that only rows of one table compare:\n\n"
        f"{table(head, cells)}"
    )


def _layers() -> str:
    stored, coverage = load("layers"), load("coverage")
    rows = []
    for row, shares in printed.PREFERENCE_LAYER.items():
        cells = []
        for n, share in zip(SIZES, shares, strict=True):
            corner = list(reference_points(n))[-1]
            values = [each["hypervolume"][corner] for each in of(stored.get(f"{n} {row}"))]
            cells += [str(share), mean_share(values)]
        rows.append([row, *cells])
    head = ["network", *(cell for n in SIZES for cell in (f"{n}, printed", "ours"))]
    graphs = []
    for row, shares in printed.GRAPH_ENCODER.items():
        entries = [coverage.get(f"{n} places: {row.lower()}, network alone") for n in PLACES]
        ours = [mean_share([each["hypervolume"] for each in of(entry)]) for entry in entries]
        graphs.append(
            [row, *(x for pair in zip(map(str, shares), ours, strict=True) for x in pair)]
        )
    head_graphs = ["network", *(cell for n in PLACES for cell in (f"{n}, printed", "ours"))]
    return (
        "## Ablations\n\nWithout the preference layer a network cannot tell preferences apart and "
        "gives one tour for all.\n`python -m tests.benchmarks layers`, 40 cities at (50, 50):\n\n"
        f"{table(head, rows)}\nWithout the encoder of graphs, on maps:\n\n"
        f"{table(head_graphs, graphs)}"
    )


def _concave() -> str:
    stored = load("concave")
    rows = [
        [name, str(len(stored[key])), str(stored["different"][key]), str(stored["gap"][key])]
        for key, name in (("rays", "rays"), ("weighted_sums", "weighted sums"))
        if stored
    ]
    head = ["", "problems solved", "different points", "largest distance between neighbours"]
    return (
        "## The concave front of the appendix\n\n`python -m tests.benchmarks concave`: rays find "
        "points all along it, weighted sums its two ends.\n\n"
        f"{table(head, rows)}\n![The concave front](results/concave.png)\n"
    )


def _fronts() -> str:
    return (
        "## Fronts\n\n`python -m tests.benchmarks fronts`: the paper's first instance of each "
        "size.\n\n![Fronts at 40 and 500 cities](results/fronts.png)\n"
    )
