"""The command `paretour coverage`."""

from functools import partial

from service.cli.options import (
    ActorName,
    ApiKey,
    AsCsv,
    AsJson,
    AsTable,
    CellSize,
    CostLayer,
    End,
    EndPose,
    MapFile,
    Open,
    Paths,
    PlotMap,
    Repairs,
    RobotRadius,
    Robots,
    Seed,
    Size,
    Spacing,
    Start,
    StartPose,
    TimeLimit,
    Unknown,
    Url,
)


def coverage(  # noqa: PLR0913  an option each
    file: MapFile,
    cell_size: CellSize = None,
    robot_radius: RobotRadius = None,
    spacing: Spacing = None,
    cost_layer: CostLayer = None,
    start_pose: StartPose = None,
    end_pose: EndPose = None,
    robots: Robots = None,
    unknown: Unknown = None,
    paths: Paths = None,
    time_limit: TimeLimit = None,
    size: Size = None,
    start: Start = None,
    end: End = None,
    open_routes: Open = None,
    seed: Seed = None,
    actor: ActorName = None,
    repairs: Repairs = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
    as_table: AsTable = False,
    plot: PlotMap = None,
    url: Url = None,
    api_key: ApiKey = None,
) -> None:
    """Plan the front of tours of a robot through places all over a map, or of plans for several."""
    from service.cli.backends import backend_for
    from service.cli.fronts import OutputFormat, run_front
    from service.cli.plans import plan_map

    options = {
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
        partial(plan_map, file, cost_layer, options, poses, robots or ()),
        backend_for(url, api_key),
        OutputFormat(as_json=as_json, as_csv=as_csv, as_table=as_table, plot=plot),
    )
