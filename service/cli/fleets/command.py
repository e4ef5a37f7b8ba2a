"""The command `paretour fleet`."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

from typer import Option

from service.cli.options import ApiKey, AsJson, FleetFile, Seed, TimeLimit, Url, VehiclesFile

if TYPE_CHECKING:
    from paretour import Plan


def fleet(  # noqa: PLR0913  an option each
    file: FleetFile,
    vehicles: VehiclesFile = None,
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
    from service.cli.data import print_csv, print_data
    from service.cli.errors import UsageError, exit_on_error
    from service.cli.fleets.output import plans_as_rows, plans_as_table

    console = Console(stderr=True)
    with exit_on_error():
        if as_json and as_csv:
            raise UsageError("a front is printed as --json or --csv, not as both")
        plan = read_fleet(file, vehicles, {"time_limit": time_limit, "size": size, "seed": seed})
        front = backend_for(url, api_key).fleet(plan, console)
    if as_json:
        print_data(json.dumps(front.document))
    elif as_csv:
        print_csv(plans_as_rows(front))
    else:
        Console().print(plans_as_table(front))
    found = f"{len(front.plans)} of {front.points} plans, hypervolume {front.hypervolume:.6g}"
    console.print(found, highlight=False)


def read_fleet(file: Path, vehicles: Path | None, options: dict[str, Any]) -> "Plan":
    """Return the plan in a file, or in two of stops and vehicles.

    Options that are given replace its members.

    Raises:
        UnreadableFile: It cannot be read.
        UsageError: It is a request for another command.
        OSError: There is no such file.
    """
    from paretour import FleetRequest, fleet_plan

    from service.cli.inputs import read_request

    request, _ = read_request([file] if vehicles is None else [file, vehicles], "fleet")
    given = {name: value for name, value in options.items() if value is not None}
    return fleet_plan(cast(FleetRequest, {**request, **given}))
