"""Plan, print and draw a front of any kind for the command; a table has what differs by kind."""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from paretour import Front, FrontOfAnyKind, Plan, RobotFront
from paretour.choice import the_way
from paretour.expect import unexpected
from paretour.kinds import kind_of
from rich.console import Console
from rich.table import Table

from service.cli.backends import Backend
from service.cli.data import print_csv, print_data
from service.cli.errors import UsageError, exit_on_error
from service.cli.inputs import Ids
from service.cli.options import OutputFormat, Ways
from service.cli.output import (
    ROBOTS,
    VEHICLES,
    Movers,
    Rows,
    actors_as_table,
    front_as_rows,
    front_as_table,
    front_summary,
    ids_of,
    labels_of,
    named_tours,
    plans_as_rows,
    plans_as_table,
    stops_of,
    three_tours,
    tour_as_json,
    tour_summary,
    uncovered_summary,
)
from service.cli.terminal_chart import LABELS, draw_front

BuildPlan = Callable[[], tuple[Plan, Ids | None]]


@dataclass(frozen=True, kw_only=True)
class _Kind:
    """How to print and draw fronts of a kind.

    Args:
        noun: The name of what they hold.
        rows: Returns the rows of a front for CSV, with the ids of its stops, if they have any.
        table: Returns a table of a front, with a row for each tour or plan.
        under_chart: Returns the table to print under the chart on a terminal.
        hint: The options that print more.
        draw: Draws a front, the answer to a plan, into a file. It imports matplotlib when it is
            called.
    """

    noun: str
    rows: Callable[[Any, Ids | None], Rows]
    table: Callable[[Any], Table]
    under_chart: Callable[[Any], Table]
    hint: str
    draw: Callable[[Any, Plan, Path], None]


def _draw_lengths(noun: str) -> Callable[[FrontOfAnyKind, Plan, Path], None]:
    def draw(front: FrontOfAnyKind, _: Plan, path: Path) -> None:
        from service.cli.plot import plot_front

        plot_front(front, path, noun)

    return draw


def _draw_map(front: Front | RobotFront, plan: Plan, path: Path) -> None:
    """Draw three tours or plans over the map; only the lengths if there are no paths or no map."""
    if isinstance(front, Front) and (front.paths is None or plan.path != "/coverage"):
        return _draw_lengths("tours")(front, plan, path)
    from service.cli.plot import plot_map

    names = [each.name for each in front.objectives or ()] or LABELS
    return plot_map(front, plan, path, three_tours(front.lengths, names))


def _kind_of_tours(draw: Callable[[Front, Plan, Path], None]) -> _Kind:
    return _Kind(
        noun="tours",
        rows=lambda front, ids: front_as_rows(front, ids or ids_of(front)),
        table=front_as_table,
        under_chart=named_tours,
        hint="--table prints every tour, --csv its cities too",
        draw=draw,
    )


def _kind_of_plans(movers: Movers, draw: Callable[[Any, Plan, Path], None]) -> _Kind:
    table = partial(plans_as_table, movers=movers)
    return _Kind(
        noun="plans",
        rows=lambda front, _: plans_as_rows(front, movers),
        table=table,
        under_chart=table,
        hint="--csv prints every route",
        draw=draw,
    )


_KINDS: Mapping[str, _Kind] = {
    "front": _kind_of_tours(_draw_lengths("tours")),
    "coverage": _kind_of_tours(_draw_map),
    "fleet": _kind_of_plans(VEHICLES, _draw_lengths("plans")),
    "robots": _kind_of_plans(ROBOTS, _draw_map),
}


def run_front(build_plan: BuildPlan, backend: Backend, output: OutputFormat) -> None:
    """Plan a front, print it and draw it."""
    with exit_on_error():
        _check_output(output)
        plan, ids = build_plan()
        front = backend.front(plan, Console(stderr=True))
        kind = _KINDS[kind_of(front.document)]
        _print(front, kind, ids, output)
        if output.plot is not None:
            kind.draw(front, plan, output.plot)
    _print_line(front_summary(front, kind.noun))
    if line := uncovered_summary(front):
        _print_line(line)


def run_tour(build_plan: BuildPlan, backend: Backend, choice: Ways, as_json: bool = False) -> None:
    """Plan a front and print one of its tours."""
    ways = vars(choice)
    with exit_on_error():
        with _usage_errors():
            the_way(ways)
        plan, ids = build_plan()
        front = backend.front(plan, Console(stderr=True))
        if not isinstance(front, Front):
            raise unexpected("answer/kind", "of tours", front.document["kind"])
        with _usage_errors():
            tour = front.choose(**ways)
    if as_json:
        print_data(tour_as_json(tour))
    else:
        print_csv([stops_of(tour.tour, ids or ids_of(front))], delimiter=" ")
    _print_line(tour_summary(front, tour))


def run_actors(backend: Backend, as_json: bool) -> None:
    """Print the actors to choose from."""
    with exit_on_error():
        actors = backend.actors()
    if as_json:
        print_data(json.dumps({"actors": [vars(actor) for actor in actors]}))
    else:
        Console().print(actors_as_table(actors))


@contextmanager
def _usage_errors() -> Iterator[None]:
    """Turn a ValueError of the block into a UsageError."""
    try:
        yield
    except ValueError as error:
        raise UsageError(str(error)) from None


def _print(front: FrontOfAnyKind, kind: _Kind, ids: Ids | None, output: OutputFormat) -> None:
    console = Console()
    if output.as_json:
        print_data(json.dumps(front.document))
    elif output.as_csv:
        print_csv(kind.rows(front, ids))
    elif console.is_terminal and len(front.lengths) and not output.as_table:
        print_chart(front, console)
        console.print(kind.under_chart(front))
        _print_line(kind.hint)
    else:
        console.print(kind.table(front))


def print_chart(front: FrontOfAnyKind, console: Console) -> None:
    """Print a chart of a front on a console."""
    point = "•" if console.encoding.startswith("utf") else "o"
    chart = draw_front(front.lengths, point, labels_of(front))
    console.print(chart, highlight=False, markup=False)


def _print_line(line: str) -> None:
    """Print a line about the results on stderr."""
    Console(stderr=True).print(line, highlight=False, markup=False)


def _check_output(output: OutputFormat) -> None:
    """Raise UsageError if two formats are asked for, or nothing can be drawn into the file."""
    if output.as_json + output.as_csv + output.as_table > 1:
        raise UsageError("a front is printed as one of --json, --csv and --table")
    if output.plot is None:
        return
    try:
        from service.cli.plot import check_path
    except ModuleNotFoundError:
        raise UsageError("--plot needs matplotlib: pip install 'paretour[plot]'") from None
    check_path(output.plot)
