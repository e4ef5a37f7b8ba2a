"""The command `paretour fleet`: plan several vehicles, and print the front of their plans."""

import csv
import io
import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

from typer import Argument, Option, echo

from service.cli.options import ApiKey, AsJson, Seed, TimeLimit, Url

if TYPE_CHECKING:
    from paretour import FleetFront, Plan
    from rich.table import Table


def fleet(  # noqa: PLR0913  an option each
    file: Annotated[Path, Argument(help="A request in JSON, as for POST /fleet.")],
    time_limit: TimeLimit = None,
    size: Annotated[int | None, Option(help="The most plans to give.", show_default="100")] = None,
    seed: Seed = None,
    as_json: AsJson = False,
    as_csv: Annotated[bool, Option("--csv", help="Print a line for each route.")] = False,
    url: Url = None,
    api_key: ApiKey = None,
) -> None:
    """Plan the front of plans for several vehicles."""
    from rich.console import Console

    from service.cli.backends import backend_for
    from service.cli.errors import UsageError, exit_on_error

    console = Console(stderr=True)
    with exit_on_error():
        if as_json and as_csv:
            raise UsageError("a front is printed as --json or --csv, not as both")
        plan = read_fleet(file, {"time_limit": time_limit, "size": size, "seed": seed})
        front = backend_for(url, api_key).fleet(plan, console)
    if as_json:
        echo(json.dumps(front.document))
    elif as_csv:
        echo(fleet_as_csv(front))
    else:
        Console().print(fleet_as_table(front))
    found = f"{len(front.plans)} of {front.points} plans, hypervolume {front.hypervolume:.6g}"
    console.print(found, highlight=False)


def read_fleet(file: Path, options: dict[str, Any]) -> "Plan":
    """Return the plan in a file of JSON, with options that were given in place of its members.

    Raises:
        UnreadableFile: It is no JSON object.
        OSError: There is no such file.
    """
    from paretour import FleetRequest, fleet_plan

    from service.cli.errors import UnreadableFile

    try:
        request = json.loads(file.read_text())
    except (ValueError, RecursionError) as error:
        raise UnreadableFile(f"{file} must be JSON: {error}") from None
    if not isinstance(request, dict):
        raise UnreadableFile(f"{file} must hold an object, as a request is")
    given = {name: value for name, value in options.items() if value is not None}
    return fleet_plan(cast(FleetRequest, {**request, **given}))


def fleet_as_csv(front: "FleetFront") -> str:
    """Return a line for each route: its plan, the plan's lengths, and its own vehicle and stops."""
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    names = [each.name for each in front.objectives]
    lines.writerow(
        ("plan", "balance", *names, "vehicle", *(f"route {name}" for name in names), "stops")
    )
    for number, plan in enumerate(front.plans):
        for route in plan.routes:
            lengths = (*plan.lengths.tolist(), route.vehicle, *route.lengths.tolist())
            lines.writerow((number, plan.balance, *lengths, " ".join(route.stops)))
    return text.getvalue().rstrip()


def fleet_as_table(front: "FleetFront") -> "Table":
    """Return a table with a row for each plan."""
    from rich.markup import escape
    from rich.table import Table

    headings = (
        each.name if each.unit is None else f"{each.name} ({each.unit})"
        for each in front.objectives
    )
    table = Table("plan", "balance", *map(escape, headings), "vehicles", "left out")
    for column in table.columns:
        column.justify = "right"
    for number, plan in enumerate(front.plans):
        lengths = (f"{length:.6g}" for length in plan.lengths)
        counts = (str(len(plan.routes)), str(len(plan.unassigned)))
        table.add_row(str(number), f"{plan.balance:.3f}", *lengths, *counts)
    return table
