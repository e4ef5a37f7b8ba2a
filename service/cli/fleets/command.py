"""The command `paretour fleet`."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

from typer import Argument, Option, echo

from service.cli.options import ApiKey, AsJson, Seed, TimeLimit, Url

if TYPE_CHECKING:
    from paretour import Plan


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
    from service.cli.fleets.output import plans_as_csv, plans_as_table

    console = Console(stderr=True)
    with exit_on_error():
        if as_json and as_csv:
            raise UsageError("a front is printed as --json or --csv, not as both")
        plan = read_fleet(file, {"time_limit": time_limit, "size": size, "seed": seed})
        front = backend_for(url, api_key).fleet(plan, console)
    if as_json:
        echo(json.dumps(front.document))
    elif as_csv:
        echo(plans_as_csv(front))
    else:
        Console().print(plans_as_table(front))
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
