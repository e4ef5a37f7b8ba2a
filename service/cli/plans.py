"""Build the request that files and options ask for together.

Functions that read files raise OSError if one does not exist, UnreadableFile if one cannot be read,
and UsageError if one is for another command, or if numbers are not written with commas between.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

from paretour import (
    CoverageRequest,
    FleetRequest,
    FrontRequest,
    Plan,
    ReplanRequest,
    coverage_plan,
    fleet_plan,
    front_plan,
    replan_plan,
)

from service.cli.errors import UsageError
from service.cli.inputs import FileRequest, Ids, check_inputs, read_layer, read_object, read_request
from service.cli.options import ANY

_SECOND_OBJECTIVES = ("second_matrix", "cost_layer", "cost_layers", "second_coordinates")

Options = Mapping[str, Any]  # members of a request; a member that is None is left to the file


def plan_cities(
    files: Sequence[Path],
    *,
    unrounded: bool = False,
    angles: str | None = None,
    options: Options,
) -> tuple[Plan, Ids | None]:
    """Return the plan for the cities in a file, or in one for each objective; and their ids."""
    found = read_request(files, "front", unrounded=unrounded)
    return _cities(found, options, angles), found.ids


def _cities(found: FileRequest, options: Options, angles: str | None = None) -> Plan:
    preferences = _parse_numbers(angles, "--angles")
    given = _without_none({**options, **_ends(options, found.ids), "preferences": preferences})
    return front_plan(cast(FrontRequest, {**found.request, **given}))


def plan_tour(
    files: Sequence[Path],
    cost_layers: Sequence[Path],
    *,
    unrounded: bool = False,
    options: Options,
) -> tuple[Plan, Ids | None]:
    """Return the plan of one tour, of cities as by `plan_cities` or on a map as by `plan_map`."""
    check_inputs(*files, *cost_layers)
    options = _with_poses(options)
    found = read_request(files, "front", "coverage", unrounded=unrounded)
    if found.request.get("robots"):
        raise UsageError(f"{files[0]} is about several robots: `paretour coverage` plans that")
    if found.kind == "coverage":
        return _map(found, cost_layers, options), None
    if cost_layers:
        raise UsageError(f"--cost-layer is for a map, and {files[0]} is not one")
    return _cities(found, options), found.ids


def plan_rest(front: str, changes: Path | None, options: Options) -> tuple[Plan, None]:
    """Return the plan for the rest of a front's way, and no ids.

    Args:
        front: The id of the front.
        changes: A file of members of the request, as JSON.
        options: Further members; lists of stops are their ids with commas between.
    """
    request = {} if changes is None else read_object(changes)
    given = _without_none(options)
    given |= {name: given[name].split(",") for name in ("done", "remove") if name in given}
    return replan_plan(front, cast(ReplanRequest, {**request, **given})), None


def plan_fleet(file: Path, vehicles: Path | None, options: Options) -> tuple[Plan, None]:
    """Return the plan for a fleet in a file, or in one of stops and one of vehicles; and no ids."""
    found = read_request([file, vehicles], "fleet")
    return fleet_plan(cast(FleetRequest, {**found.request, **_without_none(options)})), None


def plan_map(
    file: Path, cost_layers: Sequence[Path], options: Options, robots: Sequence[str] = ()
) -> tuple[Plan, None]:
    """Return the plan for places on the map in a file, maybe with costs in others; and no ids.

    Args:
        file: The map, or a request.
        cost_layers: Files of costs.
        options: Members of the request; poses are numbers with commas between.
        robots: The poses where several robots start, in the same form. They share the places.

    Raises:
        UsageError: Something that a plan needs is missing; the message names everything that is.
    """
    check_inputs(file, *cost_layers)
    parsed = _with_poses(options)
    return _map(read_request([file], "coverage"), cost_layers, parsed, robots), None


def _map(
    found: FileRequest, cost_layers: Sequence[Path], options: Options, robots: Sequence[str] = ()
) -> Plan:
    members = {**_costs(cost_layers), "robots": _parse_robots(robots)}
    given = _without_none({**options, **_ends(options, None), **members})
    whole = {**found.request, **given}
    _check_complete(whole)
    return coverage_plan(cast(CoverageRequest, whole), found.picture)


def _costs(files: Sequence[Path]) -> dict[str, Any]:
    """Return the member of a request that has the costs in these files, if there are any."""
    match files:
        case []:
            return {}
        case [one]:
            return {"cost_layer": read_layer(one)}
    return {"cost_layers": [{"name": each.stem, "layer": read_layer(each)} for each in files]}


def _with_poses(options: Options) -> Options:
    """Return options with poses as lists of numbers."""
    poses = {
        name: _parse_numbers(options.get(name), f"--{name.replace('_', '-')}")
        for name in ("start_pose", "end_pose")
    }
    return {**options, **poses}


def _parse_robots(poses: Sequence[str]) -> list[dict[str, Any]] | None:
    """Return a robot for each pose, robot-1 the first; None without poses."""
    starts = [_parse_numbers(pose, "--robot") for pose in poses]
    robots = [
        {"id": f"robot-{number}", "start_pose": start} for number, start in enumerate(starts, 1)
    ]
    return robots or None


def _check_complete(request: Mapping[str, Any]) -> None:
    needs = {
        "--cell-size": ("cell_size", "occupancy_grid"),
        "--spacing (or places in a request)": ("spacing", "places"),
        "--cost-layer (or second_matrix or second_coordinates in a request)": _SECOND_OBJECTIVES,
    }
    if request.get("robots"):  # their second objective is the longest route
        needs.popitem()
    missing = [need for need, members in needs.items() if not request.keys() & set(members)]
    if missing:
        raise UsageError(f"a map cannot be covered without {', '.join(missing)}")


def _ends(options: Options, ids: Ids | None) -> dict[str, int | str | None]:
    """Return start and end as indexes, given as indexes or as ids in the file; else as they are."""
    ends: dict[str, int | str | None] = {}
    for name in ("start", "end"):
        text = options.get(name)
        if text is None or text in (ids or ()):
            ends[name] = None if text is None or ids is None else ids.index(text)
        else:
            ends[name] = int(text) if text.isdecimal() else text
    return ends


def _parse_numbers(text: str | None, option: str) -> list[float] | None:
    try:
        return None if text is None else [float(number) for number in text.split(",")]
    except ValueError:
        sentence = f"{option} must be numbers with commas between, got {text!r}"
        raise UsageError(sentence) from None


def _without_none(options: Options) -> dict[str, Any]:
    """Return the options that were given, with null for `any`."""
    given = {name: value for name, value in options.items() if value is not None}
    return {**given, "start": None} if given.get("start") == ANY else given
