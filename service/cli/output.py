"""Print tours, fronts of tours and actors: data on stdout, a line about it on stderr."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray
from paretour import Actor, Choice, FleetFront, Front, FrontOfAnyKind, Plan, Tour
from paretour.choice import the_way
from paretour.expect import unexpected
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from service.cli.backends import Backend
from service.cli.data import csv_text, print_csv, print_data
from service.cli.errors import UsageError, exit_on_error
from service.cli.inputs import Ids
from service.cli.labels import columns_of, ids_of, labels_of, lengths_as_text
from service.cli.terminal_chart import LABELS, draw_front
from service.errors.printable import printable

BuildPlan = Callable[[], tuple[Plan, Ids | None]]

_STDERR = Console(stderr=True)
_TERMINATED: Mapping[str | None, str] = {
    None: "still being planned",
    "converged": "nothing more was found",
    "time_limit": "stopped at the time limit",
    "cancelled": "stopped before its time",
}


def run_tour(
    build_plan: BuildPlan, backend: Backend, angle: float | None, choice: Choice, as_json: bool
) -> None:
    """Plan a front and print one of its tours, at an angle in degrees or by another choice."""
    with exit_on_error():
        with _usage_errors():
            the_way(angle, choice)
        plan, ids = build_plan()
        front = backend.front(plan, _STDERR)
        if not isinstance(front, Front):
            raise unexpected("answer/kind", "of tours", front.document["kind"])
        with _usage_errors():
            tour = front.choose(angle, **choice)
    if as_json:
        print_data(tour_as_json(tour))
    else:
        print_csv([stops_of(tour.tour, ids or ids_of(front))], delimiter=" ")
    _STDERR.print(tour_summary(front, tour), highlight=False, markup=False)


@contextmanager
def _usage_errors() -> Iterator[None]:
    """Turn a ValueError of the block into a UsageError."""
    try:
        yield
    except ValueError as error:
        raise UsageError(str(error)) from None


def run_actors(backend: Backend, as_json: bool) -> None:
    """Print the actors to choose from."""
    with exit_on_error():
        actors = backend.actors()
    if as_json:
        print_data(actors_as_json(actors))
    else:
        Console().print(actors_as_table(actors))


def front_as_rows(front: Front, ids: Ids | None = None) -> list[tuple[object, ...]]:
    """Return a row for each tour, with spaces between its cities, or between their ids.

    As in CSV, an id is quoted if it has a space or a quotation mark in it.
    """
    found = zip(front.angles, front.lengths, front.tours, strict=True)
    rows = [
        (float(angle), *lengths.tolist(), csv_text([stops_of(tour, ids)], delimiter=" "))
        for angle, lengths, tour in found
    ]
    return [("angle", *columns_of(front), "tour"), *rows]


def front_as_table(front: Front) -> Table:
    """Return a table with a row for each tour, without its cities."""
    table = Table("balance", "angle", *map(escape, labels_of(front)))
    for column in table.columns:
        column.justify = "right"
    for balance, angle, lengths in zip(front.balances, front.angles, front.lengths, strict=True):
        shown = (f"{length:.6g}" for length in lengths)
        table.add_row(f"{balance:.3f}", f"{angle:.2f}", *shown)
    return table


def print_chart(front: FrontOfAnyKind, console: Console) -> None:
    """Print a chart of a front on a console."""
    point = "•" if console.encoding.startswith("utf") else "o"
    chart = draw_front(front.lengths, point, labels_of(front))
    console.print(chart, highlight=False, markup=False)


def named_tours(front: Front) -> Table:
    """Return a table of three tours of a front: both ends and the knee."""
    table = Table("tour", "balance", "angle", *map(escape, labels_of(front)))
    for column in table.columns[1:]:
        column.justify = "right"
    named = front.objectives
    names = None if named is None else [printable(each.name) for each in named]
    for name, i in three_tours(front.lengths, names or LABELS).items():
        lengths = (f"{length:.6g}" for length in front.lengths[i])
        balance, angle = f"{front.balances[i]:.3f}", f"{front.angles[i]:.2f}"
        table.add_row(escape(name), balance, angle, *lengths)
    return table


def front_summary(front: FrontOfAnyKind, noun: str = "tours") -> str:
    """Return a line about a front: its size, its hypervolume, and how its search ended."""
    found = f"{len(front.lengths)} of {front.points} {noun} found"
    bound = front.hypervolume_bound if isinstance(front, Front) else None
    most = "" if bound is None else f", and no front has more than {bound:.2%}"
    return f"{found}, hypervolume {front.hypervolume:.2%}{most}; {end_of_search(front.terminated)}"


def print_uncovered(front: FrontOfAnyKind, console: Console) -> None:
    """Print a line about the cells of a map that no path leads to, if there are any."""
    uncovered = None if isinstance(front, FleetFront) else front.uncovered
    if uncovered is None or not uncovered.regions:
        return
    row, column = uncovered.regions[0].cell
    cells = "cell" if uncovered.cells == 1 else "cells"
    size = f"{uncovered.cells} free {cells}, {uncovered.square_metres:.6g} m²"
    line = (
        f"not covered, as no path leads there: {size}; the largest part is around [{row}, {column}]"
    )
    console.print(line, highlight=False, markup=False)


def end_of_search(terminated: str | None) -> str:
    """Return why a search ended, in words."""
    return _TERMINATED.get(terminated, f"ended: {terminated!r:.80}")


def tour_as_json(tour: Tour) -> str:
    """Return a tour as the service answers it, without the front's id."""
    members = {
        "angle": tour.angle,
        "balance": tour.balance,
        "lengths": tour.lengths.tolist(),
        "tour": tour.tour.tolist(),
    }
    return json.dumps(members if tour.stops is None else {**members, "stops": tour.stops})


def stops_of(tour: NDArray[np.int64], ids: Ids | None = None) -> list[int] | list[str]:
    """Return the cities of a tour, shape (n,), as ids if they have any."""
    return tour.tolist() if ids is None else [ids[city] for city in tour]


def tour_summary(front: Front, tour: Tour) -> str:
    """Return a line about the balance, the angle and the lengths of a tour of a front."""
    first, second = tour.lengths.tolist()
    where = f"balance {tour.balance:.3f}, angle {tour.angle:.2f}"
    return f"{where}, {lengths_as_text(front, (first, second))}"


def actors_as_json(actors: Iterable[Actor]) -> str:
    """Return the actors as the service answers them."""
    return json.dumps({"actors": [vars(actor) for actor in actors]})


def actors_as_table(actors: Iterable[Actor]) -> Table:
    """Return a table with a row for each actor."""
    table = Table("name", "reads", "trained on cities", "digest")
    for actor in actors:
        texts = actor.name, actor.inputs, str(actor.sizes), actor.digest[:12]
        table.add_row(*(escape(printable(text)) for text in texts))
    return table


def three_tours(lengths: NDArray[np.float64], names: Sequence[str] = LABELS) -> dict[str, int]:
    """Return the indexes and titles of three points: both ends and the knee. Points: (m, 2)."""
    first, second = names
    low, high = lengths.min(axis=0), lengths.max(axis=0)
    box = np.where(high > low, high - low, 1.0)
    return {
        f"least {first}": int(np.lexsort((lengths[:, 1], lengths[:, 0]))[0]),
        "knee": int(((lengths - low) / box).sum(axis=1).argmin()),
        f"least {second}": int(np.lexsort((lengths[:, 0], lengths[:, 1]))[0]),
    }
