"""Plan, print and draw a front of any kind for the command."""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from paretour import Front, FrontOfAnyKind, Plan
from paretour.choice import numbers_in, the_way
from paretour.expect import unexpected
from paretour.kinds import Kind, kind_of
from rich.console import Console

from service.cli.backends import Backend
from service.cli.data import print_csv, print_data
from service.cli.errors import UsageError, exit_on_error
from service.cli.inputs import Ids
from service.cli.notes import print_request_notes
from service.cli.options import OutputFormat, Ways
from service.cli.output import (
    actors_as_table,
    front_as_rows,
    front_as_table,
    front_summary,
    ids_of,
    labels_of,
    named_points,
    named_tours,
    plans_as_rows,
    plans_as_table,
    stops_of,
    tour_as_json,
    tour_summary,
    uncovered_summary,
)
from service.cli.paths import check_path_file, check_path_folder, write_path, write_paths
from service.cli.terminal_chart import LABELS, draw_front
from service.objectives import OBJECTIVES

_MORE_TOURS = "--table prints every tour, --csv its cities too"
_MORE_PLANS = "--csv prints every route"
BuildPlan = Callable[[], tuple[Plan, Ids | None]]


def run_front(
    build_plan: BuildPlan, backend: Backend, output: OutputFormat, path_folder: Path | None = None
) -> None:
    """Plan a front, print it and draw it; write its paths into a folder."""
    with exit_on_error():
        _check_output(output)
        if path_folder is not None:
            check_path_folder(path_folder)
        plan, ids = build_plan()
        front = backend.front(plan, Console(stderr=True))
        kind = kind_of(front.document)
        _print(front, kind, ids, output)
        if output.plot is not None:
            _draw(front, plan, output.plot, kind)
        if path_folder is not None:
            write_paths(front, kind, path_folder)
    print_request_notes(front.notes)
    _print_line(front_summary(front, kind.item))
    if line := uncovered_summary(front):
        _print_line(line)


def run_tour(
    build_plan: BuildPlan,
    backend: Backend,
    choice: Ways,
    as_json: bool = False,
    path_file: Path | None = None,
) -> None:
    """Plan a front and print one of its tours; write its path into a file."""
    with exit_on_error():
        if path_file is not None:
            check_path_file(path_file)
        with _usage_errors():
            ways = _as_numbers(vars(choice))
            the_way(ways)
        plan, ids = build_plan()
        front = backend.front(plan, Console(stderr=True))
        if not isinstance(front, Front):
            raise unexpected("answer/kind", "of tours", front.document["kind"])
        with _usage_errors():
            tour = front.choose(**ways)
        if path_file is not None:
            write_path(tour.path, path_file)
    if as_json:
        print_data(tour_as_json(tour))
    else:
        print_csv([stops_of(tour.tour, ids or ids_of(front))], delimiter=" ")
    print_request_notes(front.notes)
    _print_line(tour_summary(front, tour))


def run_actors(backend: Backend, as_json: bool) -> None:
    """Print the actors to choose from."""
    with exit_on_error():
        actors = backend.actors()
    if as_json:
        print_data(json.dumps({"actors": [vars(actor) for actor in actors]}))
    else:
        Console().print(actors_as_table(actors))


def _as_numbers(ways: Mapping[str, Any]) -> dict[str, Any]:
    """Return ways to choose with names and numbers in place of texts such as `time:0.5`."""
    return {
        name: list(numbers_in(f"--{name.replace('_', '-')}", value))
        if isinstance(value, list)
        else value
        for name, value in ways.items()
    }


@contextmanager
def _usage_errors() -> Iterator[None]:
    """Turn a ValueError of the block into a UsageError."""
    try:
        yield
    except ValueError as error:
        raise UsageError(str(error)) from None


def _print(front: Any, kind: Kind, ids: Ids | None, output: OutputFormat) -> None:
    """Print a front of any kind: on a terminal as a chart, unless another format is asked for."""
    console = Console()
    chart = console.is_terminal and len(front.lengths) and not output.as_table
    if output.as_json:
        print_data(json.dumps(front.document))
    elif output.as_csv:
        rows = (
            plans_as_rows(front, kind) if kind.mover else front_as_rows(front, ids or ids_of(front))
        )
        print_csv(rows)
    elif not chart:
        console.print(plans_as_table(front, kind) if kind.mover else front_as_table(front))
    else:
        print_chart(front, console)
        console.print(plans_as_table(front, kind) if kind.mover else named_tours(front))
        _print_line(_MORE_PLANS if kind.mover else _MORE_TOURS)


def _draw(front: Any, plan: Plan, path: Path, kind: Kind) -> None:
    """Draw a front of any kind into a file; if it has paths over a map, three of them as well."""
    from service.cli.plot import plot_front, plot_map

    if plan.path != "/coverage" or (not kind.mover and front.paths is None):
        return plot_front(front, path, f"{kind.item}s")
    names = [each.name for each in front.objectives or ()] or LABELS
    return plot_map(front, plan, path, named_points(front.lengths, names))


def print_chart(front: FrontOfAnyKind, console: Console) -> None:
    """Print a chart of a front on a console, under its first two objectives."""
    point = "•" if console.encoding.startswith("utf") else "o"
    chart = draw_front(front.lengths[:, :OBJECTIVES], point, labels_of(front)[:OBJECTIVES])
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
