"""Run the commands that plan, and print results: data on stdout, a line about it on stderr."""

import csv
import io
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from paretour import Actor, Front, Plan, Tour
from rich.console import Console
from rich.table import Table
from typer import echo

from service.cli.backends import Backend
from service.cli.errors import UsageError, exit_on_error

BuildPlan = Callable[[], Plan]

_STDERR = Console(stderr=True)
_TERMINATED: Mapping[str | None, str] = {
    None: "still being planned",
    "converged": "nothing more was found",
    "time_limit": "stopped at the time limit",
    "cancelled": "stopped before its time",
}


@dataclass(frozen=True, kw_only=True)
class OutputFormat:
    """The format to print a front in, a table by default, and the file to draw it into."""

    as_json: bool = False
    as_csv: bool = False
    plot: Path | None = None

    def check(self) -> None:
        """Raise UsageError if two formats are asked for."""
        if self.as_json and self.as_csv:
            raise UsageError("a front is printed as --json or as --csv, not as both")


def run_front(build_plan: BuildPlan, backend: Backend, output: OutputFormat) -> None:
    """Plan a front, print it and draw it."""
    with exit_on_error():
        output.check()
        draw = None if output.plot is None else _drawing_into(output.plot)
        front = backend.front(build_plan(), _STDERR)
        _print(front, output)
        if draw is not None:
            draw(front)
    _STDERR.print(front_summary(front), highlight=False)


def run_tour(build_plan: BuildPlan, backend: Backend, angle: float, as_json: bool) -> None:
    """Plan a front and print its tour nearest to an angle in degrees."""
    with exit_on_error():
        front = backend.front(build_plan(), _STDERR)
    tour = front.nearest(angle)
    echo(tour_as_json(tour) if as_json else tour_as_text(tour.tour))
    _STDERR.print(tour_summary(tour), highlight=False)


def run_actors(backend: Backend, as_json: bool) -> None:
    """Print the actors to choose from."""
    with exit_on_error():
        actors = backend.actors()
    if as_json:
        echo(actors_as_json(actors))
    else:
        Console().print(actors_as_table(actors))


def front_as_json(front: Front) -> str:
    """Return a front as the service answers it."""
    return json.dumps(front.document)


def front_as_csv(front: Front) -> str:
    """Return a line for each tour, with spaces between its cities."""
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(("angle", "length_1", "length_2", "tour"))
    for angle, lengths, tour in zip(front.angles, front.lengths, front.tours, strict=True):
        lines.writerow((float(angle), *lengths.tolist(), tour_as_text(tour)))
    return text.getvalue().rstrip()


def front_as_table(front: Front) -> Table:
    """Return a table with a row for each tour, without its cities."""
    table = Table("angle", "first length", "second length")
    for column in table.columns:
        column.justify = "right"
    for angle, lengths in zip(front.angles, front.lengths, strict=True):
        table.add_row(f"{angle:.2f}", *(f"{length:.6g}" for length in lengths))
    return table


def front_summary(front: Front) -> str:
    """Return a line about the size, the hypervolume and the end of a front's search."""
    found = f"{len(front.tours)} of {front.points} tours found"
    bound = front.hypervolume_bound
    most = "" if bound is None else f", and no front has more than {bound:.2%}"
    return f"{found}, hypervolume {front.hypervolume:.2%}{most}; {_TERMINATED[front.terminated]}"


def tour_as_json(tour: Tour) -> str:
    """Return a tour as the service answers it, without the front's id."""
    members = {"angle": tour.angle, "lengths": tour.lengths.tolist(), "tour": tour.tour.tolist()}
    return json.dumps(members)


def tour_as_text(tour: NDArray[np.int64]) -> str:
    """Return the cities of a tour, shape (n,), with spaces between."""
    return " ".join(map(str, tour.tolist()))


def tour_summary(tour: Tour) -> str:
    """Return a line about the angle and the lengths of a tour."""
    first, second = tour.lengths
    return f"angle {tour.angle:.2f}, lengths {first:.6g} and {second:.6g}"


def actors_as_json(actors: Iterable[Actor]) -> str:
    """Return the actors as the service answers them."""
    return json.dumps({"actors": [vars(actor) for actor in actors]})


def actors_as_table(actors: Iterable[Actor]) -> Table:
    """Return a table with a row for each actor."""
    table = Table("name", "reads", "trained on cities", "digest")
    for actor in actors:
        table.add_row(actor.name, actor.inputs, str(actor.sizes), actor.digest[:12])
    return table


def _print(front: Front, output: OutputFormat) -> None:
    if output.as_json:
        echo(front_as_json(front))
    elif output.as_csv:
        echo(front_as_csv(front))
    else:
        Console().print(front_as_table(front))


def _drawing_into(path: Path) -> Callable[[Front], None]:
    """Return a function that draws a front into a file.

    Raises:
        UsageError: No picture can be drawn into it, or matplotlib is not installed.
    """
    try:
        from service.cli.plot import check_path, plot_front
    except ModuleNotFoundError:
        raise UsageError("--plot needs matplotlib: pip install 'paretour[plot]'") from None
    check_path(path)
    return lambda front: plot_front(front, path)
