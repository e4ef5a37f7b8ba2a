"""Make rows for CSV, tables and sentences from fronts, with names, units and ids."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from paretour import (
    Actor,
    FleetFront,
    FleetPlan,
    Front,
    FrontOfAnyKind,
    RobotFront,
    RobotPlan,
    Tour,
)
from paretour.choice import losses
from paretour.described import document_of
from paretour.kinds import Kind
from rich.markup import escape
from rich.table import Table

from service.amounts.said import on_most_days
from service.cli.data import csv_text
from service.cli.inputs import Ids, ids_in
from service.cli.terminal_chart import LABELS
from service.errors.printable import printable
from service.fleet.measures.table import MEASURES
from service.objectives import OBJECTIVES

Rows = list[tuple[object, ...]]
FrontOfPlans = FleetFront | RobotFront
_COLUMNS = [name for name, each in MEASURES.items() if each.column]  # measures of plans in CSV
_TERMINATED: Mapping[str | None, str] = {
    None: "still being planned",
    "converged": "nothing more was found",
    "time_limit": "stopped at the time limit",
    "cancelled": "stopped before its time",
}


def labels_of(front: FrontOfAnyKind) -> tuple[str, ...]:
    """Return the labels of all lengths: the name of the objective, with its unit if it has one."""
    if front.objectives is None:
        return LABELS[: front.lengths.shape[1]]
    return tuple(map(printable, front.labels))


def ids_of(front: Front) -> Ids | None:
    """Return the id of each stop, by its index; None if the answer does not name all stops."""
    ids = ids_in(front.document.get("stops"))
    return None if ids is None or len(ids) < front.tours.shape[1] else ids


def stops_of(tour: NDArray[np.int64], ids: Ids | None = None) -> list[int] | list[str]:
    """Return the cities of a tour, shape (n,), as ids if they have any."""
    return tour.tolist() if ids is None else [ids[city] for city in tour]


def front_as_rows(front: Front, ids: Ids | None = None) -> Rows:
    """Return a row for each tour, with spaces between its cities, or between their ids.

    As in CSV, an id is quoted if it has a space or a quotation mark in it.
    """
    before = {"angle": front.angles} if front.lengths.shape[1] == OBJECTIVES else {}
    if front.departures is not None:
        before["departure"] = front.departures
    after = _spread_columns(front)
    rows = [
        (
            *(float(values[k]) for values in before.values()),
            *lengths.tolist(),
            *(float(values[k]) for values in after.values()),
            _cities(tour, ids),
        )
        for k, (lengths, tour) in enumerate(zip(front.lengths, front.tours, strict=True))
    ]
    return [(*before, *front.labels, *after, "tour"), *rows]


def _spread_columns(front: Front) -> dict[str, NDArray[np.float64]]:
    """Return the means of the lengths that spread and what nine days of ten do not exceed."""
    if front.means is None or front.p90 is None:
        return {}
    columns = zip(front.labels, front.means.T, front.p90.T, strict=True)
    spreading = [(name, mean, most) for name, mean, most in columns if (most > mean).any()]
    return {
        **{f"mean {name}": mean for name, mean, _ in spreading},
        **{f"p90 {name}": most for name, _, most in spreading},
    }


def _cities(tour: NDArray[np.int64], ids: Ids | None) -> str:
    return csv_text([stops_of(tour, ids)], delimiter=" ")


def plans_as_rows(front: FrontOfPlans, kind: Kind, numbers: Iterable[int] | None = None) -> Rows:
    """Return a row for each route: plan, lengths of the plan, vehicle or robot, stops.

    Args:
        numbers: Those of the plans to return; by default all.
    """
    names = front.names
    measures = [each.get("measure") for each in front.document["objectives"]]
    of_routes = [
        "whole route" if measure == "imbalance" else f"route {name}"
        for name, measure in zip(names, measures, strict=True)
    ]
    flat = len(names) == OBJECTIVES
    standing = ("balance",) if flat else ()
    plans: Sequence[Any] = front.plans
    known = getattr(plans[0], "measures", {}) if plans else {}
    spreading = [name for name in _COLUMNS if name in known]
    rows: Rows = [("plan", *standing, *names, *spreading, kind.mover, *of_routes, kind.visits)]
    for number in range(len(plans)) if numbers is None else numbers:
        plan = plans[number]
        for route, (mover, visits) in zip(plan.routes, kind.routes(plan), strict=True):
            of_plan = (*plan.lengths.tolist(), *(plan.measures[name] for name in spreading))
            lengths = (*of_plan, mover, *route.lengths.tolist())
            text = csv_text([visits], delimiter=" ")
            rows.append((number, *((plan.balance,) if flat else ()), *lengths, text))
    return rows


def front_as_table(front: Front) -> Table:
    """Return a table with a row for each tour, without its cities."""
    rows = [_cells(front, index) for index in range(len(front.lengths))]
    return table_of((*_positions(front), *labels_of(front)), rows)


def named_tours(front: Front) -> Table:
    """Return a table of some tours of a front: the least under each objective, and the knee."""
    named = front.objectives
    labels = LABELS[: front.lengths.shape[1]]
    names = labels if named is None else [printable(each.name) for each in named]
    found = named_points(front.lengths, names).items()
    table = table_of(
        ("tour", *_positions(front), *labels_of(front)),
        [(escape(name), *_cells(front, index)) for name, index in found],
    )
    table.columns[0].justify = "left"
    return table


def plans_as_table(front: FrontOfPlans, kind: Kind) -> Table:
    """Return a table with a row for each plan."""
    flat = front.lengths.shape[1] == OBJECTIVES
    rows = []
    plans: Sequence[FleetPlan | RobotPlan] = front.plans
    for number, plan in enumerate(plans):
        lengths = (f"{length:.6g}" for length in plan.lengths)
        counts = (str(count(plan)) for count in kind.counts.values())
        balance = (f"{plan.balance:.3f}",) if flat else ()
        rows.append((str(number), *balance, *lengths, *counts))
    standing = ("balance",) if flat else ()
    return table_of(("plan", *standing, *labels_of(front), *kind.counts), rows)


def actors_as_table(actors: Iterable[Actor]) -> Table:
    """Return a table with a row for each actor."""
    table = Table("name", "reads", "trained on cities", "digest")
    for actor in actors:
        texts = actor.name, actor.inputs, str(actor.sizes), actor.digest[:12]
        table.add_row(*(escape(printable(text)) for text in texts))
    return table


def table_of(headings: Iterable[str], rows: Iterable[Iterable[str]]) -> Table:
    """Return a table of numbers."""
    table = Table()
    for heading in headings:
        table.add_column(escape(heading), justify="right")
    for row in rows:
        table.add_row(*row)
    return table


def _positions(front: Front) -> tuple[str, ...]:
    """Return the headings of what comes before the lengths: where a tour of two objectives stands.

    And when it begins, over the day.
    """
    between = ("balance", "angle") if front.lengths.shape[1] == OBJECTIVES else ()
    return between if front.departures is None else (*between, "departure")


def _cells(front: Front, index: int) -> tuple[str, ...]:
    """Return all lengths of a tour, after what `_positions` has."""
    cells = [f"{length:.6g}" for length in front.lengths[index]]
    if front.departures is not None:
        minutes, seconds = divmod(round(front.departures[index]), 60)
        cells.insert(0, f"{minutes // 60:02}:{minutes % 60:02}:{seconds:02}")
    if front.lengths.shape[1] != OBJECTIVES:
        return tuple(cells)
    return (f"{front.balances[index]:.3f}", f"{front.angles[index]:.2f}", *cells)


def named_points(lengths: NDArray[np.float64], names: Sequence[str] = LABELS) -> dict[str, int]:
    """Return the indexes and titles of the points with the least of each length, and of the knee.

    The knee comes after the first. Points have shape (k, m).
    """
    sums = losses(lengths).sum(axis=1)
    least = {
        f"least {name}": int(np.lexsort((sums, lengths[:, m]))[0])
        for m, name in enumerate(names[: lengths.shape[1]])
    }
    (title, first), *others = least.items()
    return {title: first, "knee": int(sums.argmin()), **dict(others)}


def tour_as_json(tour: Tour) -> str:
    """Return a tour as the service answers it, without the front's id and the way over a map."""
    members = document_of(tour).items()
    return json.dumps({name: each for name, each in members if name not in ("front", "path")})


def lengths_as_text(front: FrontOfAnyKind, lengths: NDArray[np.float64]) -> str:
    """Return all lengths of a tour, with names and units if any, as the end of a sentence."""
    shown = [f"{length:.6g}" for length in lengths]
    if front.objectives is None:
        return f"lengths {', '.join(shown[:-1])} and {shown[-1]}"
    return ", ".join(
        printable(" ".join(filter(None, (each.name, length, each.unit))))
        for each, length in zip(front.objectives, shown, strict=True)
    )


def tour_summary(front: Front, tour: Tour) -> str:
    """Return a line about a tour of a front: its lengths, of two after its balance and angle.

    Of lengths that spread it says their means, and what nine days of ten do not exceed.
    """
    lengths = "".join((lengths_as_text(front, tour.lengths), *_spreading(front, tour)))
    if len(tour.lengths) > OBJECTIVES:
        return lengths
    return f"balance {tour.balance:.3f}, angle {tour.angle:.2f}, {lengths}"


def _spreading(front: Front, tour: Tour) -> Iterator[str]:
    """Yield the end of a sentence for each length that spreads."""
    if tour.means is None or tour.p90 is None:
        return
    for each, mean, most in zip(front.objectives or (), tour.means, tour.p90, strict=True):
        if most > mean:
            yield printable(f"; {each.name} {on_most_days(mean, most, each.unit)}")


def front_summary(front: FrontOfAnyKind, item: str = "tour") -> str:
    """Return a line about a front: its size, its hypervolume, and how its search ended."""
    found = f"{len(front.lengths)} of {front.points} {item}s found"
    bound = front.document.get("hypervolume_bound")
    most = "" if bound is None else f", and no front has more than {bound:.2%}"
    return f"{found}, hypervolume {front.hypervolume:.2%}{most}; {end_of_search(front.terminated)}"


def end_of_search(terminated: str | None) -> str:
    """Return why a search ended, in words."""
    return _TERMINATED.get(terminated, f"ended: {terminated!r:.80}")


def uncovered_summary(front: FrontOfAnyKind) -> str | None:
    """Return a line about the cells of a map that no path leads to, if there are any."""
    uncovered = None if isinstance(front, FleetFront) else front.uncovered
    if uncovered is None or not uncovered.regions:
        return None
    row, column = uncovered.regions[0].cell
    cells = "cell" if uncovered.cells == 1 else "cells"
    size = f"{uncovered.cells} free {cells}, {uncovered.square_metres:.6g} m²"
    largest = f"the largest part is around [{row}, {column}]"
    return f"not covered, as no path leads there: {size}; {largest}"
