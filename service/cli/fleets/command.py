"""The command `paretour fleet`."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

from typer import Option

from service.cli.options import (
    ApiKey,
    AsJson,
    FleetFile,
    Plot,
    Seed,
    TimeLimit,
    Url,
    VehiclesFile,
)

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
    as_table: Annotated[
        bool, Option("--table", help="Print all plans without a chart on a terminal too.")
    ] = False,
    plot: Plot = None,
    url: Url = None,
    api_key: ApiKey = None,
) -> None:
    """Plan the front of plans for several vehicles."""
    from service.cli.backends import backend_for
    from service.cli.fronts import OutputFormat, run_front

    options = {"time_limit": time_limit, "size": size, "seed": seed}
    run_front(
        partial(read_fleet, file, vehicles, options),
        backend_for(url, api_key),
        OutputFormat(as_json=as_json, as_csv=as_csv, as_table=as_table, plot=plot),
    )


def read_fleet(file: Path, vehicles: Path | None, options: dict[str, Any]) -> "tuple[Plan, None]":
    """Return the plan in a file, or in a file of stops and one of vehicles; and no ids.

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
    return fleet_plan(cast(FleetRequest, {**request, **given})), None
