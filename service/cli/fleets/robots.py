"""Plan several robots on a map, and print and draw the front of their plans."""

import json

from paretour import Plan, RobotFront
from rich.console import Console

from service.cli.backends import Backend
from service.cli.data import print_csv, print_data
from service.cli.errors import exit_on_error
from service.cli.fleets.output import plans_as_rows, plans_as_table
from service.cli.labels import labels_of
from service.cli.output import OutputFormat, check_plot, end_of_search, print_uncovered, three_tours
from service.cli.terminal_chart import draw_front


def run_robots(plan: Plan, backend: Backend, output: OutputFormat) -> None:
    """Plan a front of plans, print it and draw it."""
    stderr = Console(stderr=True)
    with exit_on_error():
        if output.plot is not None:
            check_plot(output.plot)
        front = backend.robots(plan, stderr)
        _print(front, output, Console())
        if output.plot is not None:
            from service.cli.fleets.plot import plot_robots

            names = [each.name for each in front.objectives]
            plot_robots(front, plan, output.plot, three_tours(front.lengths, names))
    found = f"{len(front.plans)} of {front.points} plans found"
    ended = f"hypervolume {front.hypervolume:.2%}; {end_of_search(front.terminated)}"
    stderr.print(f"{found}, {ended}", highlight=False, markup=False)
    print_uncovered(front.uncovered, stderr)


def _print(front: RobotFront, output: OutputFormat, console: Console) -> None:
    if output.as_json:
        print_data(json.dumps(front.document))
    elif output.as_csv:
        print_csv(plans_as_rows(front))
    else:
        if console.is_terminal and not output.as_table:
            _print_chart(front, console)
        console.print(plans_as_table(front))


def _print_chart(front: RobotFront, console: Console) -> None:
    point = "•" if console.encoding.startswith("utf") else "o"
    chart = draw_front(front.lengths, point, labels_of(front))
    console.print(chart, highlight=False, markup=False)
