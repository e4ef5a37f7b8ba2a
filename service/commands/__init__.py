"""The commands of `paretour`.

Each imports what it needs where it runs: help, or the refusal of an option, waits for nothing.
"""

from pathlib import Path
from typing import Annotated

from typer import Argument, Option, Typer

from service.commands.options import (
    ActorName,
    Angles,
    ApiKey,
    AsJson,
    File,
    SecondFile,
    Seed,
    Size,
    Start,
    TimeLimit,
    Unrounded,
    Url,
)

app = Typer(
    name="paretour",
    help="Tours under two objectives: the whole front of trade-offs.",
    epilog="Results go to stdout, all else to stderr. Exit codes: 0 a front, also where Ctrl-C"
    " ended its search; 1 a fault of paretour; 2 a wrong command, file or request; 3 a service that"
    " cannot be reached, lets nobody in, or fails; 130 Ctrl-C before there was a front.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


@app.command()
def front(  # noqa: PLR0913  an option each
    file: File,
    file2: SecondFile = None,
    time_limit: TimeLimit = None,
    angles: Angles = None,
    size: Size = None,
    start: Start = None,
    seed: Seed = None,
    actor: ActorName = None,
    unrounded: Unrounded = False,
    as_json: AsJson = False,
    as_csv: Annotated[bool, Option("--csv", help="Print a line for each tour.")] = False,
    plot: Annotated[Path | None, Option(help="Draw the front into this file.")] = None,
    url: Url = None,
    api_key: ApiKey = None,
) -> None:
    """Plan the front of tours through the cities of a file, or of one for each objective."""
    from service.commands.asking import Asked, Planner
    from service.commands.run import Shown, run_front

    options = {"time_limit": time_limit, "size": size, "start": start, "seed": seed, "actor": actor}
    run_front(
        Asked(file=file, file2=file2, unrounded=unrounded, angles=angles, options=options),
        Planner(url, api_key),
        Shown(as_json=as_json, as_csv=as_csv, plot=plot),
    )


@app.command()
def tour(  # noqa: PLR0913  an option each
    file: File,
    file2: SecondFile = None,
    *,
    angle: Annotated[
        float, Option(min=0, max=90, help="The trade-off: near 0 the second length is small.")
    ],
    time_limit: TimeLimit = None,
    start: Start = None,
    seed: Seed = None,
    actor: ActorName = None,
    unrounded: Unrounded = False,
    as_json: AsJson = False,
    url: Url = None,
    api_key: ApiKey = None,
) -> None:
    """Plan a front and print its tour nearest to an angle."""
    from service.commands.asking import Asked, Planner
    from service.commands.run import run_tour

    options = {"time_limit": time_limit, "start": start, "seed": seed, "actor": actor}
    asked = Asked(file=file, file2=file2, unrounded=unrounded, options=options)
    run_tour(asked, Planner(url, api_key), angle, as_json)


@app.command()
def actors(as_json: AsJson = False, url: Url = None, api_key: ApiKey = None) -> None:
    """List the networks to choose from."""
    from service.commands.asking import Planner
    from service.commands.run import run_actors

    run_actors(Planner(url, api_key), as_json)


@app.command()
def serve(
    host: Annotated[str | None, Option(help="Address to listen on.", show_default=False)] = None,
    port: Annotated[
        int | None, Option(help="Port to listen on; 0 takes a free one.", show_default=False)
    ] = None,
    workers: Annotated[int | None, Option(help="Plans made at a time.", show_default=False)] = None,
) -> None:
    """Answer requests over HTTP; other settings come from PARETOUR_* variables."""
    from service.commands.serving import run_serve

    run_serve(host, port, workers)


@app.command()
def key(
    caller: Annotated[str, Argument(help="Who will show the key.")],
) -> None:
    """Make an API key for a caller, and the entry for PARETOUR_API_KEYS that lets it in."""
    from service.commands.keys import run_key

    run_key(caller)
