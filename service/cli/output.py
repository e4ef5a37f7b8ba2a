"""Results of the command: tables, JSON, CSV and pictures on stdout, talk on stderr."""

import csv
import io
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from paretour import Actor, Front, Tour
from rich.console import Console
from rich.table import Table
from typer import echo

from service.cli.backends import Asked, Planner
from service.cli.errors import UsageError, explaining

_ENDS: Mapping[str | None, str] = {
    None: "still being planned",
    "converged": "nothing more was found",
    "time_limit": "stopped at the time limit",
    "cancelled": "stopped before its time",
}


def front_as_json(front: Front) -> str:
    """As the service answers it."""
    return json.dumps(front.document)


def front_as_csv(front: Front) -> str:
    """A line for each tour, with spaces between its cities."""
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(("angle", "length_1", "length_2", "tour"))
    for angle, lengths, tour in zip(front.angles, front.lengths, front.tours, strict=True):
        lines.writerow((float(angle), *lengths.tolist(), tour_as_text(tour)))
    return text.getvalue().rstrip()


def front_as_table(front: Front) -> Table:
    """A row for each tour, without its cities."""
    table = Table("angle", "first length", "second length")
    for column in table.columns:
        column.justify = "right"
    for angle, lengths in zip(front.angles, front.lengths, strict=True):
        table.add_row(f"{angle:.2f}", *(f"{length:.6g}" for length in lengths))
    return table


def front_in_words(front: Front) -> str:
    """What there is to say of it in a line."""
    kept = f"{len(front.tours)} of {front.points} tours found"
    bound = front.hypervolume_bound
    most = "" if bound is None else f", and no front has more than {bound:.2%}"
    return f"{kept}, hypervolume {front.hypervolume:.2%}{most}; {_ENDS[front.terminated]}"


def tour_as_json(tour: Tour) -> str:
    """As the service answers it, but for the front."""
    members = {"angle": tour.angle, "lengths": tour.lengths.tolist(), "tour": tour.tour.tolist()}
    return json.dumps(members)


def tour_as_text(tour: NDArray[np.int64]) -> str:
    """Its cities."""
    return " ".join(map(str, tour.tolist()))


def tour_in_words(tour: Tour) -> str:
    """Where it stands."""
    first, second = tour.lengths
    return f"angle {tour.angle:.2f}, lengths {first:.6g} and {second:.6g}"


def actors_as_json(actors: Iterable[Actor]) -> str:
    """As the service answers them."""
    return json.dumps({"actors": [vars(actor) for actor in actors]})


def actors_as_table(actors: Iterable[Actor]) -> Table:
    """A row for each."""
    table = Table("name", "reads", "trained on cities", "digest")
    for actor in actors:
        table.add_row(actor.name, actor.inputs, str(actor.sizes), actor.digest[:12])
    return table


_STDERR = Console(stderr=True)


@dataclass(frozen=True, kw_only=True)
class Shown:
    """How a front is shown: as a table if neither as JSON nor as CSV, and drawn into a file."""

    as_json: bool
    as_csv: bool
    plot: Path | None


def run_front(asked: Asked, planner: Planner, shown: Shown) -> None:
    """Plan a front and show it."""
    with explaining():
        if shown.as_json and shown.as_csv:
            raise UsageError("a front is printed as --json or as --csv, not as both")
        draw = None if shown.plot is None else _drawing(shown.plot)
        front = planner.front(asked.plan(), _STDERR)
        _print(front, shown)
        if draw is not None:
            draw(front)
    _STDERR.print(front_in_words(front), highlight=False)


def run_tour(asked: Asked, planner: Planner, angle: float, as_json: bool) -> None:
    """Plan a front and print the tour nearest to an angle."""
    with explaining():
        front = planner.front(asked.plan(), _STDERR)
    tour = front.nearest(angle)
    echo(tour_as_json(tour) if as_json else tour_as_text(tour.tour))
    _STDERR.print(tour_in_words(tour), highlight=False)


def run_actors(planner: Planner, as_json: bool) -> None:
    """Print which networks there are."""
    with explaining():
        actors = planner.actors()
    if as_json:
        echo(actors_as_json(actors))
    else:
        Console().print(actors_as_table(actors))


def _print(front: Front, shown: Shown) -> None:
    if shown.as_json:
        echo(front_as_json(front))
    elif shown.as_csv:
        echo(front_as_csv(front))
    else:
        Console().print(front_as_table(front))


def _drawing(path: Path) -> Callable[[Front], None]:
    try:
        from service.cli.plot import check_format, plot_front
    except ModuleNotFoundError:
        raise UsageError("--plot needs matplotlib: pip install 'paretour[plot]'") from None
    check_format(path)
    return lambda front: plot_front(front, path)
