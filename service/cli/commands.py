"""The commands of `paretour`, with their arguments and options.

Each command imports the modules that it needs when it runs, so that --help and errors in options
are fast.
"""

import sys
from functools import partial
from typing import Annotated

from typer import Argument, Exit, Option, Typer, echo

from service import installed_version
from service.cli import options
from service.cli.options import with_groups
from service.jobs.uncollected import uncollected

app = Typer(
    name="paretour",
    help="Plan tours with more than one goal, and choose among all trade-offs.",
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
def before_the_command(
    _version: Annotated[
        bool,
        Option("--version", help="Print the version.", callback=_print_version, is_eager=True),
    ] = False,
) -> None:
    """Read the options before the command."""


@app.command()
@with_groups
def front(  # noqa: PLR0913  a group of options, or one, each
    file: options.File,
    more: options.MoreFiles = None,
    *,
    members: options.OfFront,
    angles: options.Angles = None,
    unrounded: options.Unrounded = False,
    output: options.OutputFormat,
    service: options.Service,
) -> None:
    """Plan the front of tours through the cities of a file, or of one for each objective."""
    from service.cli.backends import backend_for
    from service.cli.fronts import run_front
    from service.cli.plans import plan_cities

    run_front(
        partial(
            plan_cities,
            [file, *(more or ())],
            unrounded=unrounded,
            angles=angles,
            options=vars(members),
        ),
        backend_for(service),
        output,
    )


@app.command()
@with_groups
def tour(  # noqa: PLR0913  a group of options, or one, each
    file: options.FileOrMap,
    more: options.MoreFiles = None,
    *,
    choice: options.Ways,
    members: options.OfTour,
    unrounded: options.Unrounded = False,
    cost_layers: options.CostLayers = None,
    path: options.PathFile = None,
    as_json: options.AsJson = False,
    service: options.Service,
) -> None:
    """Plan a front and print one of its tours: at an angle, at a balance, or within a budget."""
    from service.cli.backends import backend_for
    from service.cli.fronts import run_tour
    from service.cli.plans import plan_tour

    paths = None if path is None else True
    run_tour(
        partial(
            plan_tour,
            [file, *(more or ())],
            cost_layers or (),
            unrounded=unrounded,
            options={**vars(members), "paths": paths},
        ),
        backend_for(service),
        choice,
        as_json,
        path,
    )


@app.command()
@with_groups
def ask(
    front: options.AskedFront,
    *,
    asking: options.Asking,
    as_json: options.AsJson = False,
    service: options.Service,
) -> None:
    """Choose a tour or plan by a few questions: which of these is best?"""
    from service.cli.ask import run_ask

    run_ask(front, asking, as_json, service)


@app.command()
@with_groups
def replan(
    front_id: options.FrontId,
    changes: options.Changes = None,
    *,
    url: options.ServiceUrl,
    api_key: options.ApiKey = None,
    members: options.OfRest,
    output: options.OutputFormat,
) -> None:
    """Plan the rest of a tour when things have changed, from a front that a service has."""
    from service.cli.backends import RemoteBackend
    from service.cli.fronts import run_front
    from service.cli.plans import plan_rest

    run_front(
        partial(plan_rest, front_id, changes, vars(members)),
        RemoteBackend(url, api_key),
        output,
    )


@app.command()
@with_groups
def offers(
    front_id: options.FrontId,
    asked: options.AskedOffers,
    *,
    url: options.ServiceUrl,
    api_key: options.ApiKey = None,
    as_json: options.AsJson = False,
) -> None:
    """Say in which slots an order can be promised beside a fleet's plan, and what each costs."""
    from service.cli.backends import RemoteBackend
    from service.cli.offers import run_offers

    run_offers(front_id, asked, as_json, RemoteBackend(url, api_key))


@app.command()
@with_groups
def fleet(
    file: options.FleetFile,
    vehicles: options.VehiclesFile = None,
    *,
    members: options.OfFleet,
    output: options.OutputFormat,
    service: options.Service,
) -> None:
    """Plan the front of plans for several vehicles."""
    from service.cli.backends import backend_for
    from service.cli.fronts import run_front
    from service.cli.plans import plan_fleet

    run_front(partial(plan_fleet, file, vehicles, vars(members)), backend_for(service), output)


@app.command()
@with_groups
def coverage(  # noqa: PLR0913  a group of options, or one, each
    file: options.MapFile,
    *,
    members: options.OfMap,
    cost_layers: options.CostLayers = None,
    robots: options.Robots = None,
    path_folder: options.PathFolder = None,
    output: options.OutputFormat,
    service: options.Service,
) -> None:
    """Plan the front of tours of a robot through places all over a map, or of plans for several."""
    from service.cli.backends import backend_for
    from service.cli.fronts import run_front
    from service.cli.plans import plan_map

    asked = vars(members)
    if path_folder is not None or output.plot is not None:  # the picture shows the paths of tours
        asked = {**asked, "paths": True}
    run_front(
        partial(plan_map, file, cost_layers or (), asked, robots or ()),
        backend_for(service),
        output,
        path_folder,
    )


@app.command()
@with_groups
def actors(*, as_json: options.AsJson = False, service: options.Service) -> None:
    """List the networks to choose from."""
    from service.cli.backends import backend_for
    from service.cli.fronts import run_actors

    run_actors(backend_for(service), as_json)


@app.command()
def serve(
    host: Annotated[str | None, Option(help="Address to listen on.", show_default=False)] = None,
    port: Annotated[
        int | None, Option(help="Port to listen on; 0 takes a free one.", show_default=False)
    ] = None,
    workers: options.Workers = None,
) -> None:
    """Answer requests over HTTP; other settings come from PARETOUR_* variables."""
    from service.jobs.workers import fork_server

    with uncollected(), fork_server.interrupts_blocked():
        from service import server
        from service.cli.configuration import load_settings, load_with
        from service.cli.errors import exit_on_error

    with exit_on_error():
        settings = load_settings(host=host, port=port, workers=workers)
        ending = server.Ending()
        built = load_with(partial(server.build, ending=ending), settings)
    server.serve(built, settings, ending)


@app.command()
def work(
    workers: options.Workers = None,
    alive: Annotated[
        bool,
        Option(
            "--alive",
            help="Only check this machine: exit with 0 if a worker takes tasks, else with 1.",
        ),
    ] = False,
) -> None:
    """Plan tasks of services with the same PARETOUR_REDIS_URL; needs the extra cluster."""
    from service import server
    from service.cli.configuration import load_settings, load_with
    from service.cli.errors import EXIT_STALLED, exit_on_error, exit_with

    with exit_on_error():
        settings = load_settings(workers=workers)
        if not alive:
            run = load_with(server.build_worker, settings)
        elif load_with(server.takes_work, settings):
            return
        else:
            raise exit_with("no worker on this machine takes waiting tasks", EXIT_STALLED)
    sys.exit(run())


@app.command()
@with_groups
def mcp(*, service: options.Service) -> None:
    """Let an agent plan, by the Model Context Protocol on stdin and stdout; needs the extra mcp."""
    from service.cli.agents import serve_agent
    from service.cli.errors import exit_on_error

    with exit_on_error():
        serve_agent(service)


@app.command()
def key(
    caller: Annotated[str, Argument(help="The name of the caller who will use the key.")],
) -> None:
    """Make an API key for a caller, and the entry for PARETOUR_API_KEYS that lets it in."""
    from service.api.keys import KeyHash, new_key
    from service.cli.errors import UsageError, exit_on_error

    made, digest = new_key()
    with exit_on_error():
        try:
            KeyHash(caller=caller, digest=digest)
        except ValueError as error:
            raise UsageError(str(error)) from None
    echo(f"{made}\n{caller}:{digest}")
    echo("The key, for its caller alone; then its entry for PARETOUR_API_KEYS.", err=True)
