"""What is stored of fleets, as tables: a table for each set of the benchmark `fleets`."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from service.pareto import hypervolume, nondominated
from tests.benchmarks import printed
from tests.benchmarks.best_known import known_plan
from tests.benchmarks.cells import MISSING, mean_seconds, of
from tests.benchmarks.fleet_fronts import share_of_box
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load
from tests.benchmarks.rows import Points

OURS, NO_SEARCH = "paretour", "paretour without a search"
SWEEP, ALONE = "PyVRP in a sweep", "PyVRP alone"
EARLIER = "the earlier engine with PyVRP"
VROOM, OR_TOOLS, OR_TOOLS_SWEEP = "VROOM", "OR-Tools", "OR-Tools in a sweep"
_HIT = 0.01  # by which a distance may exceed a best known one, which has two decimals
Front = list[list[float]]


class BiCvrp(NamedTuple):
    """Instances of the literature with one number of customers."""

    seconds: float
    corner: tuple[float, float]  # the reference point


BI_CVRP = {
    20: BiCvrp(0.7, (30.0, 4.0)),
    50: BiCvrp(1.5, (45.0, 4.0)),
    100: BiCvrp(3.6, (80.0, 4.0)),
}
_ABOUT = {
    "uniform": "Places uniform in a square, demands 1 to 29, capacity 200; total against longest "
    "route. Hypervolumes are in the box\nof the fronts of a row, and least totals are compared "
    "with the least of all.",
    "bi-cvrp": "The frame of the literature on neural solvers: total against longest route, the "
    "hypervolume in its box, with the\nstandard error of the mean. The first rows are printed, of "
    "200 other instances of the recipe. Instances differ more\nthan methods do, so methods are to "
    "be compared on the same ones.",
    "streets": "Orders on the streets of Helsinki, every third for an hour, after which it is "
    "late: driving against lateness; of\nthree, the longest route too. The earlier engine "
    "is that of commit e0d108ee. Hypervolumes are in the box\nof both fronts.",
    "reloads": "Places uniform in a square, 6 vehicles for 100 stops, which load three or four "
    "times, and every second stop has a\nwindow; total against longest route.",
    "x": "CVRPLIB X, total against longest route: how far the least total is above the best known, "
    "and how many plans the\nfront has.",
    "hfvrp": "Mixed fleets of Pessoa, Sadykov and Uchoa (2018), total cost against longest route: "
    "how far the least cost is above\nthat of the best known routes, and how many plans the front "
    "has.",
    "solomon": "Solomon's instances of 100 customers, distance against vehicles.",
    "homberger": "Instances of Gehring and Homberger of 200 to 1000 customers, distance against "
    "vehicles.",
    "li-lim": "Li and Lim's instances of 100 customers, with shipments, distance against vehicles.",
    "longest": "Instances of Solomon's, distance against the longest route: the time on the way "
    "with service and waiting. Hypervolumes\nare in the box of both fronts.",
}
_ENDS = (
    "Rivals plan twice, with the whole time for each end.\nThe best known plans have the fewest "
    "vehicles, and with these the least distance. A distance is compared where vehicles\nare as "
    "few; the least distance, with any number of vehicles, with the best known routes of CVRPLIB.\n"
)


def section() -> str:
    """The section of the page of results; nothing before the first run."""
    stored = load("fleets")
    tables = [f"{_ABOUT[name]}\n\n{table_of(name)}" for name in _ABOUT if _rows(stored, name)]
    if not tables:
        return ""
    return (
        "\n## Fleets\n\nNot in the paper: `python -m tests.benchmarks fleets`. On one thread, and "
        "rivals have the same seconds.\n\n" + "\n".join(tables)
    )


def table_of(name: str) -> str:
    """Return the table of a set."""
    rows = _rows(load("fleets"), name)
    match name:
        case "uniform" | "streets" | "reloads" | "longest":
            return _boxes(rows)
        case "bi-cvrp":
            return _bi_cvrp(rows)
        case "x" | "hfvrp":
            return _gaps(rows)
    return f"{_ENDS}\n{_ends(rows)}"


Rows = Mapping[str, Mapping[str, dict[str, Any]]]  # entries by group and method


def _rows(stored: Mapping[str, Any], name: str) -> Rows:
    """Return the latest entry of each group and method of a set."""
    rows: dict[str, dict[str, dict[str, Any]]] = {}
    for key, entry in stored.items():
        found = re.fullmatch(rf"{name}: (.+), (.+), [\d.]+ s", key)
        if found and of(entry):
            rows.setdefault(found[1], {})[found[2]] = entry
    return rows


def _methods(rows: Rows) -> list[str]:
    return list(dict.fromkeys(method for entries in rows.values() for method in entries))


def _in_their_box(fronts: Sequence[Front]) -> list[float]:
    """Return the hypervolume of each front in the box of the best points of all of them."""
    together = np.array([point for front in fronts for point in front])
    box = together[nondominated(together)]
    return [share_of_box(np.array(front), box) for front in fronts]


def _boxes(rows: Rows) -> str:
    """A row for each group and method: the means over the instances that all were measured on."""
    lines = []
    for group, entries in rows.items():
        count = min(len(of(entry)) for entry in entries.values())
        fronts = {method: _fronts(entry)[:count] for method, entry in entries.items()}
        volumes, above = _compared(list(fronts.values()))
        compared = len(fronts.keys() - {ALONE}) > 1
        for number, (method, of_method) in enumerate(fronts.items()):
            sizes = np.mean([len(front) for front in of_method])
            volume = f"{volumes[number]:.3f}" if compared else MISSING
            of_front = ["", ""] if method == ALONE else [volume, f"{sizes:.0f}"]
            above_least = f"{100 * above[number]:.2f} %"
            seconds = mean_seconds(entries[method])
            lines.append([f"{group} ({count})", method, *of_front, above_least, f"{seconds} s"])
    head = ["(instances)", "", "hypervolume", "plans", "least total above the least found", "in"]
    return table(head, lines)


def _fronts(entry: dict[str, Any]) -> list[Front]:
    return [each["points"] for each in of(entry)]


def _compared(fronts: list[list[Front]]) -> tuple[Points, Points]:
    """Return the mean hypervolume of each method, and how far its least total is above the least.

    Where a method found no plan, its hypervolume is 0.
    """
    volumes, above = [], []
    for of_instance in zip(*fronts, strict=True):
        found = [front for front in of_instance if front]
        in_box = iter(_in_their_box(found))
        volumes.append([next(in_box) if front else 0.0 for front in of_instance])
        least = [min((point[0] for point in front), default=np.inf) for front in of_instance]
        above.append(np.array(least) / min(least) - 1)
    return np.mean(volumes, axis=0), np.mean(above, axis=0)


def _bi_cvrp(rows: Rows) -> str:
    names = [f"{n} customers" for n in BI_CVRP]
    theirs = [
        [name, *(f"{volumes[k]:.4f}" for volumes in printed.FLEETS.values())]
        for k, name in enumerate(printed.FLEET_METHODS)
    ]
    ours = [
        [method, *(_volume(n, rows.get(f"{n} customers", {}).get(method)) for n in BI_CVRP)]
        for method in _methods(rows)
    ]
    compared = "; ".join(f"{name}: {_ahead(rows.get(name, {}))}" for name in names)
    return (
        f"{table(['', *names], [*theirs, *ours])}\nIn the box of our front and PyVRP's together, "
        f"and where ours is ahead: {compared}.\n"
    )


def _volume(n: int, entry: dict[str, Any] | None) -> str:
    corner = np.array(BI_CVRP[n].corner)
    fronts = [] if entry is None else _fronts(entry)
    if not fronts:
        return MISSING
    volumes = [hypervolume(np.array(front), corner) if front else 0.0 for front in fronts]
    error = np.std(volumes) / len(volumes) ** 0.5
    return f"{np.mean(volumes):.4f} ± {error:.4f} in {mean_seconds(entry)} s ({len(volumes)})"


def _ahead(entries: Mapping[str, dict[str, Any]]) -> str:
    both = [_fronts(entries[name]) for name in (OURS, SWEEP) if name in entries]
    pairs = zip(*both, strict=False)
    boxes = [_in_their_box(pair) for pair in pairs if len(pair) == 2 and all(pair)]
    if not boxes:
        return MISSING
    ours, theirs = np.mean(boxes, axis=0)
    share = np.mean([one >= other for one, other in boxes])
    return f"{ours:.3f} to {theirs:.3f}, {share:.0%}"


def _gaps(rows: Rows) -> str:
    """A row for each instance, and the means."""
    methods = _methods(rows)
    gaps = {group: [_gap(entries.get(each)) for each in methods] for group, entries in rows.items()}
    lines = [
        [group, *map(_per_cent, gaps[group]), _plans(entries.get(OURS)), _seconds(entries)]
        for group, entries in rows.items()
    ]
    means = np.mean(list(gaps.values()), axis=0)
    lines.append([f"mean ({len(gaps)})", *map(_per_cent, means), "", ""])
    return table(["", *methods, "our plans", "in"], lines)


def _gap(entry: dict[str, Any] | None) -> float:
    """Return how far the least total is above the best known, as a share; NaN if unknown."""
    if entry is None:
        return np.nan
    (found,) = of(entry)
    least = min((point[0] for point in found["points"]), default=np.nan)
    return float(least / found.get("least_known", np.nan) - 1)


def _per_cent(share: float) -> str:
    return "" if np.isnan(share) else f"{100 * share:.2f} %"


def _plans(entry: dict[str, Any] | None) -> str:
    return "" if entry is None else str(len(_fronts(entry)[0]))


def _seconds(entries: Mapping[str, dict[str, Any]]) -> str:
    return ", ".join(f"{mean_seconds(entry)} s" for entry in entries.values())


class _Ends(NamedTuple):
    """Both ends of a front of distance against vehicles, beside the best known plan."""

    vehicles: float  # the fewest
    excess: float  # of vehicles
    above: float  # of their distance, as a share; NaN with other vehicles than the best known
    hit: bool  # whether it is the best known plan or a better one
    least_above: float  # of the least distance, as a share; NaN if none is known


def _ends(rows: Rows) -> str:
    """A row for each method, over the instances that it was measured on."""
    lines = []
    for method in _methods(rows):
        entries = {name: each[method] for name, each in rows.items() if method in each}
        found = [(name, of(entry)[0]) for name, entry in entries.items()]
        ends = [_ends_of(name, each) for name, each in found if each["points"]]
        seconds = np.mean([each["seconds"] for _, each in found])
        lines.append(
            [
                *(method, str(len(found)), f"{sum(each.vehicles for each in ends):.0f}"),
                f"{sum(each.excess <= 0 for each in ends)}",
                _mean([each.above for each in ends]),
                f"{sum(each.hit for each in ends)}",
                _mean([each.least_above for each in ends]),
                str(len(found) - len(ends)),
                f"{seconds:.1f} s",
            ]
        )
    head = ["", "instances", "vehicles", "as few as best known", "their distance above"]
    return table([*head, "best known hit", "least distance above", "no plan", "in"], lines)


def _ends_of(name: str, found: dict[str, Any]) -> _Ends:
    points = found["points"]
    distance, vehicles = min(points, key=lambda point: (point[1], point[0]))
    least = min(point[0] for point in points) / found.get("least_known", np.nan) - 1
    known = known_plan(name)
    if known is None:
        return _Ends(vehicles, np.nan, np.nan, False, least)
    excess = vehicles - known.vehicles
    above = distance / known.distance - 1 if excess == 0 else np.nan
    hit = excess < 0 or (excess == 0 and distance <= known.distance + _HIT)
    return _Ends(vehicles, excess, above, hit, least)


def _mean(shares: Sequence[float]) -> str:
    known = [share for share in shares if not np.isnan(share)]
    return _per_cent(float(np.mean(known))) if known else ""
