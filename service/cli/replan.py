"""The command `paretour replan`."""

from functools import partial

from service.cli.options import (
    ApiKey,
    AsCsv,
    AsJson,
    AsTable,
    Changes,
    Done,
    FrontId,
    MinKept,
    Plot,
    Position,
    Remove,
    Repairs,
    Seed,
    ServiceUrl,
    Size,
    TimeLimit,
)


def replan(  # noqa: PLR0913  an option each
    front_id: FrontId,
    changes: Changes = None,
    *,
    url: ServiceUrl,
    done: Done = None,
    position: Position = None,
    remove: Remove = None,
    min_kept: MinKept = None,
    time_limit: TimeLimit = None,
    size: Size = None,
    seed: Seed = None,
    repairs: Repairs = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
    as_table: AsTable = False,
    plot: Plot = None,
    api_key: ApiKey = None,
) -> None:
    """Plan the rest of a tour when things have changed, from a front that a service has."""
    from service.cli.backends import RemoteBackend
    from service.cli.fronts import OutputFormat, run_front
    from service.cli.plans import plan_rest

    options = {
        "position": position,
        "min_kept": min_kept,
        "time_limit": time_limit,
        "size": size,
        "seed": seed,
        "repairs": repairs,
    }
    run_front(
        partial(plan_rest, front_id, changes, {"done": done, "remove": remove}, options),
        RemoteBackend(url, api_key),
        OutputFormat(as_json=as_json, as_csv=as_csv, as_table=as_table, plot=plot),
    )
