"""What each command does: results on stdout, talk on stderr."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from paretour import Front
from rich.console import Console
from typer import echo

from service.cli import showing
from service.cli.backends import Asked, Planner
from service.cli.errors import Wrong, explaining

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
            raise Wrong("a front is printed as --json or as --csv, not as both")
        draw = None if shown.plot is None else _drawing(shown.plot)
        front = planner.front(asked.plan(), _STDERR)
        _print(front, shown)
        if draw is not None:
            draw(front)
    _STDERR.print(showing.front_in_words(front), highlight=False)


def run_tour(asked: Asked, planner: Planner, angle: float, as_json: bool) -> None:
    """Plan a front and print the tour nearest to an angle."""
    with explaining():
        front = planner.front(asked.plan(), _STDERR)
    tour = front.nearest(angle)
    echo(showing.tour_as_json(tour) if as_json else showing.tour_as_text(tour.tour))
    _STDERR.print(showing.tour_in_words(tour), highlight=False)


def run_actors(planner: Planner, as_json: bool) -> None:
    """Print which networks there are."""
    with explaining():
        actors = planner.actors()
    if as_json:
        echo(showing.actors_as_json(actors))
    else:
        Console().print(showing.actors_as_table(actors))


def _print(front: Front, shown: Shown) -> None:
    if shown.as_json:
        echo(showing.front_as_json(front))
    elif shown.as_csv:
        echo(showing.front_as_csv(front))
    else:
        Console().print(showing.front_as_table(front))


def _drawing(path: Path) -> Callable[[Front], None]:
    try:
        from service.cli.plot import check_format, plot_front
    except ModuleNotFoundError:
        raise Wrong("--plot needs matplotlib: pip install 'paretour[plot]'") from None
    check_format(path)
    return lambda front: plot_front(front, path)
