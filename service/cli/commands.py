"""The commands of `paretour`, with their arguments and options.

Each command imports the modules that it needs when it runs, so that --help and errors in options
are fast.
"""

from functools import partial
from typing import Annotated

from typer import Argument, Exit, Option, Typer, echo

from service import installed_version
from service.cli.coverage import coverage
from service.cli.fleets.command import fleet
from service.cli.options import (
    ActorName,
    Angle,
    Angles,
    ApiKey,
    AsCsv,
    AsJson,
    AsTable,
    Augment,
    Balance,
    EndOrId,
    File,
    FirstAtMost,
    Knee,
    Open,
    Plot,
    Repairs,
    SecondAtMost,
    SecondFile,
    Seed,
    Size,
    StartOrId,
    TimeLimit,
    Unrounded,
    Url,
    Workers,
)
from service.cli.replan import replan

app = Typer(
    name="paretour",
    help="Tours under two objectives: the whole front of trade-offs.",
    epilog="Results go to stdout, all else to stderr. Exit codes: 0 a front, even if Ctrl-C"
    " ended its search; 1 a fault of paretour; 2 a wrong command, file or request; 3 a service that"
    " cannot be reached, refuses the key, or fails; 130 Ctrl-C before there was a front.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        echo(f"paretour {installed_version()}")
        raise Exit


@app.callback()
def options(
    _version: Annotated[
        bool,
        Option("--version", help="Print the version.", callback=_print_version, is_eager=True),
    ] = False,
) -> None:
    """Read the options before the command."""


@app.command()
def front(  # noqa: PLR0913  an option each
    file: File,
    file2: SecondFile = None,
    time_limit: TimeLimit = None,
    angles: Angles = None,
    size: Size = None,
    start: StartOrId = None,
    end: EndOrId = None,
    open_routes: Open = None,
    seed: Seed = None,
    actor: ActorName = None,
    repairs: Repairs = None,
    augment: Augment = None,
    unrounded: Unrounded = False,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
    as_table: AsTable = False,
    plot: Plot = None,
    url: Url = None,
    api_key: ApiKey = None,
) -> None:
    """Plan the front of tours through the cities of a file, or of one for each objective."""
    from service.cli.backends import backend_for
    from service.cli.fronts import OutputFormat, run_front
    from service.cli.plans import plan_cities

    options = {
        "time_limit": time_limit,
        "size": size,
        "start": start,
        "end": end,
        "closed": None if open_routes is None else not open_routes,
        "seed": seed,
        "actor": actor,
        "repairs": repairs,
        "augment": augment,
    }
    run_front(
        partial(plan_cities, file, file2, unrounded=unrounded, angles=angles, options=options),
        backend_for(url, api_key),
        OutputFormat(as_json=as_json, as_csv=as_csv, as_table=as_table, plot=plot),
    )


@app.command()
def tour(  # noqa: PLR0913  an option each
    file: File,
    file2: SecondFile = None,
    *,
    angle: Angle = None,
    balance: Balance = None,
    first_at_most: FirstAtMost = None,
    second_at_most: SecondAtMost = None,
    knee: Knee = False,
    time_limit: TimeLimit = None,
    start: StartOrId = None,
    end: EndOrId = None,
    open_routes: Open = None,
    seed: Seed = None,
    actor: ActorName = None,
    repairs: Repairs = None,
    augment: Augment = None,
    unrounded: Unrounded = False,
    as_json: AsJson = False,
    url: Url = None,
    api_key: ApiKey = None,
) -> None:
    """Plan a front and print one of its tours: at an angle, at a balance, or within a budget."""
    from paretour import Choice

    from service.cli.backends import backend_for
    from service.cli.output import run_tour
    from service.cli.plans import plan_cities

    options = {
        "time_limit": time_limit,
        "start": start,
        "end": end,
        "closed": None if open_routes is None else not open_routes,
        "seed": seed,
        "actor": actor,
        "repairs": repairs,
        "augment": augment,
    }
    build_plan = partial(plan_cities, file, file2, unrounded=unrounded, options=options)
    choice: Choice = {
        "balance": balance,
        "first_at_most": first_at_most,
        "second_at_most": second_at_most,
        "knee": knee,
    }
    run_tour(build_plan, backend_for(url, api_key), angle, choice, as_json)


app.command()(replan)
app.command()(fleet)
app.command()(coverage)


@app.command()
def actors(as_json: AsJson = False, url: Url = None, api_key: ApiKey = None) -> None:
    """List the networks to choose from."""
    from service.cli.backends import backend_for
    from service.cli.output import run_actors

    run_actors(backend_for(url, api_key), as_json)


@app.command()
def serve(
    host: Annotated[str | None, Option(help="Address to listen on.", show_default=False)] = None,
    port: Annotated[
        int | None, Option(help="Port to listen on; 0 takes a free one.", show_default=False)
    ] = None,
    workers: Workers = None,
) -> None:
    """Answer requests over HTTP; other settings come from PARETOUR_* variables."""
    from service.cli.admin import run_serve

    run_serve(host, port, workers)


@app.command()
def work(
    workers: Workers = None,
    alive: Annotated[
        bool,
        Option(
            "--alive",
            help="Only check this machine: exit with 0 if a worker takes tasks, else with 1.",
        ),
    ] = False,
) -> None:
    """Plan tasks of services with the same PARETOUR_REDIS_URL; needs the extra cluster."""
    from service.cli.admin import run_alive, run_work

    if alive:
        run_alive()
    else:
        run_work(workers)


@app.command()
def key(
    caller: Annotated[str, Argument(help="The name of the caller who will use the key.")],
) -> None:
    """Make an API key for a caller, and the entry for PARETOUR_API_KEYS that lets it in."""
    from service.cli.admin import run_key

    run_key(caller)
