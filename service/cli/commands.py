"""The commands of `paretour`, with their arguments and options.

Each command imports the modules that it needs when it runs, so that --help and errors in options
are fast.
"""

from functools import partial
from typing import Annotated

from typer import Argument, Exit, Option, Typer, echo

from service import installed_version
from service.cli import options

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
def before_the_command(
    _version: Annotated[
        bool,
        Option("--version", help="Print the version.", callback=_print_version, is_eager=True),
    ] = False,
) -> None:
    """Read the options before the command."""


@app.command()
def front(  # noqa: PLR0913  an option each
    file: options.File,
    file2: options.SecondFile = None,
    time_limit: options.TimeLimit = None,
    angles: options.Angles = None,
    size: options.Size = None,
    start: options.StartOrId = None,
    end: options.EndOrId = None,
    open_routes: options.Open = None,
    seed: options.Seed = None,
    actor: options.ActorName = None,
    repairs: options.Repairs = None,
    augment: options.Augment = None,
    unrounded: options.Unrounded = False,
    as_json: options.AsJson = False,
    as_csv: options.AsCsv = False,
    as_table: options.AsTable = False,
    plot: options.Plot = None,
    url: options.Url = None,
    api_key: options.ApiKey = None,
) -> None:
    """Plan the front of tours through the cities of a file, or of one for each objective."""
    from service.cli.backends import backend_for
    from service.cli.fronts import OutputFormat, run_front
    from service.cli.plans import plan_cities

    members = {
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
        partial(plan_cities, file, file2, unrounded=unrounded, angles=angles, options=members),
        backend_for(url, api_key),
        OutputFormat(as_json=as_json, as_csv=as_csv, as_table=as_table, plot=plot),
    )


@app.command()
def tour(  # noqa: PLR0913  an option each
    file: options.File,
    file2: options.SecondFile = None,
    *,
    angle: options.Angle = None,
    balance: options.Balance = None,
    first_at_most: options.FirstAtMost = None,
    second_at_most: options.SecondAtMost = None,
    knee: options.Knee = False,
    time_limit: options.TimeLimit = None,
    start: options.StartOrId = None,
    end: options.EndOrId = None,
    open_routes: options.Open = None,
    seed: options.Seed = None,
    actor: options.ActorName = None,
    repairs: options.Repairs = None,
    augment: options.Augment = None,
    unrounded: options.Unrounded = False,
    as_json: options.AsJson = False,
    url: options.Url = None,
    api_key: options.ApiKey = None,
) -> None:
    """Plan a front and print one of its tours: at an angle, at a balance, or within a budget."""
    from paretour import Choice

    from service.cli.backends import backend_for
    from service.cli.fronts import run_tour
    from service.cli.plans import plan_cities

    members = {
        "time_limit": time_limit,
        "start": start,
        "end": end,
        "closed": None if open_routes is None else not open_routes,
        "seed": seed,
        "actor": actor,
        "repairs": repairs,
        "augment": augment,
    }
    build_plan = partial(plan_cities, file, file2, unrounded=unrounded, options=members)
    choice: Choice = {
        "balance": balance,
        "first_at_most": first_at_most,
        "second_at_most": second_at_most,
        "knee": knee,
    }
    run_tour(build_plan, backend_for(url, api_key), angle, choice, as_json)


@app.command()
def replan(  # noqa: PLR0913  an option each
    front_id: options.FrontId,
    changes: options.Changes = None,
    *,
    url: options.ServiceUrl,
    done: options.Done = None,
    position: options.Position = None,
    remove: options.Remove = None,
    min_kept: options.MinKept = None,
    time_limit: options.TimeLimit = None,
    size: options.Size = None,
    seed: options.Seed = None,
    repairs: options.Repairs = None,
    as_json: options.AsJson = False,
    as_csv: options.AsCsv = False,
    as_table: options.AsTable = False,
    plot: options.Plot = None,
    api_key: options.ApiKey = None,
) -> None:
    """Plan the rest of a tour when things have changed, from a front that a service has."""
    from service.cli.backends import RemoteBackend
    from service.cli.fronts import OutputFormat, run_front
    from service.cli.plans import plan_rest

    members = {
        "position": position,
        "min_kept": min_kept,
        "time_limit": time_limit,
        "size": size,
        "seed": seed,
        "repairs": repairs,
    }
    run_front(
        partial(plan_rest, front_id, changes, {"done": done, "remove": remove}, members),
        RemoteBackend(url, api_key),
        OutputFormat(as_json=as_json, as_csv=as_csv, as_table=as_table, plot=plot),
    )


@app.command()
def fleet(  # noqa: PLR0913  an option each
    file: options.FleetFile,
    vehicles: options.VehiclesFile = None,
    time_limit: options.TimeLimit = None,
    size: options.FleetSize = None,
    seed: options.Seed = None,
    as_json: options.AsJson = False,
    as_csv: options.RoutesAsCsv = False,
    as_table: options.PlansAsTable = False,
    plot: options.Plot = None,
    url: options.Url = None,
    api_key: options.ApiKey = None,
) -> None:
    """Plan the front of plans for several vehicles."""
    from service.cli.backends import backend_for
    from service.cli.fronts import OutputFormat, run_front
    from service.cli.plans import plan_fleet

    members = {"time_limit": time_limit, "size": size, "seed": seed}
    run_front(
        partial(plan_fleet, file, vehicles, members),
        backend_for(url, api_key),
        OutputFormat(as_json=as_json, as_csv=as_csv, as_table=as_table, plot=plot),
    )


@app.command()
def coverage(  # noqa: PLR0913  an option each
    file: options.MapFile,
    cell_size: options.CellSize = None,
    robot_radius: options.RobotRadius = None,
    spacing: options.Spacing = None,
    cost_layer: options.CostLayer = None,
    start_pose: options.StartPose = None,
    end_pose: options.EndPose = None,
    robots: options.Robots = None,
    unknown: options.Unknown = None,
    paths: options.Paths = None,
    time_limit: options.TimeLimit = None,
    size: options.Size = None,
    start: options.Start = None,
    end: options.End = None,
    open_routes: options.Open = None,
    seed: options.Seed = None,
    actor: options.ActorName = None,
    repairs: options.Repairs = None,
    as_json: options.AsJson = False,
    as_csv: options.AsCsv = False,
    as_table: options.AsTable = False,
    plot: options.PlotMap = None,
    url: options.Url = None,
    api_key: options.ApiKey = None,
) -> None:
    """Plan the front of tours of a robot through places all over a map, or of plans for several."""
    from service.cli.backends import backend_for
    from service.cli.fronts import OutputFormat, run_front
    from service.cli.plans import plan_map

    members = {
        "cell_size": cell_size,
        "robot_radius": robot_radius,
        "spacing": spacing,
        "unknown": unknown,
        # The picture shows the paths of tours.
        "paths": True if plot is not None else paths,
        "time_limit": time_limit,
        "size": size,
        "start": start,
        "end": end,
        "closed": None if open_routes is None else not open_routes,
        "seed": seed,
        "actor": actor,
        "repairs": repairs,
    }
    poses = {"start_pose": start_pose, "end_pose": end_pose}
    run_front(
        partial(plan_map, file, cost_layer, members, poses, robots or ()),
        backend_for(url, api_key),
        OutputFormat(as_json=as_json, as_csv=as_csv, as_table=as_table, plot=plot),
    )


@app.command()
def actors(
    as_json: options.AsJson = False, url: options.Url = None, api_key: options.ApiKey = None
) -> None:
    """List the networks to choose from."""
    from service.cli.backends import backend_for
    from service.cli.fronts import run_actors

    run_actors(backend_for(url, api_key), as_json)


@app.command()
def serve(
    host: Annotated[str | None, Option(help="Address to listen on.", show_default=False)] = None,
    port: Annotated[
        int | None, Option(help="Port to listen on; 0 takes a free one.", show_default=False)
    ] = None,
    workers: options.Workers = None,
) -> None:
    """Answer requests over HTTP; other settings come from PARETOUR_* variables."""
    from service.cli.admin import run_serve

    run_serve(host, port, workers)


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
