"""`python -m tests.benchmarks routing --data FOLDER`: distance against vehicles, beside solvers.

Reads files of a folder as the service reads them: of Solomon, of Gehring and Homberger, of Li and
Lim (.txt), and of CVRPLIB (.vrp). Distances are not rounded, except in CVRPLIB. We plan one front
of distance against the number of vehicles in ten seconds. Each rival plans twice, ten seconds each:
for the least distance, and for the fewest vehicles, where using one costs as much as twenty of the
longest leg. All have one thread, and each plan is checked. VROOM has its greatest exploration level
and ends on its own, before the ten seconds or at them.

With `--store` it stores `results/routing.json`; what is stored is not measured again.
"""

import argparse
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from pydantic_core import to_json

from service.errors import Refusal
from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.planner import plan_fleet
from service.fleet.plans import Plan
from service.requests.fleet import parse_fleet_request
from service.settings import Settings
from tests.benchmarks.fleet_fronts import Find, timed_front
from tests.benchmarks.rivals.ortools_fleets import route_in_time
from tests.benchmarks.rivals.pyvrp_fleets import route_by_pyvrp
from tests.benchmarks.rivals.vroom_fleets import route_by_vroom
from tests.benchmarks.routing_table import OR_TOOLS, OURS, PYVRP, VROOM, routing_table
from tests.benchmarks.rows import resume

SECONDS = 10.0
LEGS_OF_VEHICLE = 20  # the longest legs that a vehicle costs where there should be few
Solve = Callable[[Fleet, float, float], Plan | None]  # with a cost of a vehicle, in seconds
RIVALS: Mapping[str, Solve] = {
    PYVRP: route_by_pyvrp,
    VROOM: route_by_vroom,
    OR_TOOLS: route_in_time,
}


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks routing", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="holds .txt and .vrp files")
    parser.add_argument("--seconds", type=float, default=SECONDS)
    options = parser.parse_args(arguments)
    finders = {OURS: ours, **{name: partial(twice, solve) for name, solve in RIVALS.items()}}
    for path in sorted(path for path in options.data.iterdir() if path.suffix in (".txt", ".vrp")):
        fleet = read_fleet(path)
        for name, find in finders.items():
            resume(
                "routing",
                f"{path.stem}, {name}",
                "",
                [fleet],
                partial(measured, find, options.seconds),
            )
    print(routing_table())


def read_fleet(path: Path) -> Fleet:
    """The fleet of a file, under distance and the number of vehicles."""
    reading = read_files([NamedFile(path.name, path.read_bytes())], Bounds(), wanted="fleet")
    first, second = reading.request["objectives"]
    timed = "clock" in reading.request
    request = {
        **reading.request,
        "objectives": [
            {**first, "name": "distance", "over": "sum"},
            {"name": "vehicles", "measure": "vehicles"},
        ],
        **({"clock": {**second, "name": "time"}} if timed else {}),
    }
    if timed:
        del request["clock"]["over"]
    return parse_fleet_request(to_json(request), Settings().limits).subject().fleet()


def measured(find: Find, seconds: float, fleet: Fleet) -> dict[str, Any]:
    """Seconds for each plan or front, and the nondominated points."""
    spent, points = timed_front(find, fleet, seconds)
    return {"seconds": spent, "points": points.round(3).tolist()}


def ours(fleet: Fleet, seconds: float) -> list[Plan]:
    """The plans of this project."""
    try:
        return list(plan_fleet(fleet, FleetOptions(time_limit=seconds)).plans)
    except Refusal:
        return []


def twice(solve: Solve, fleet: Fleet, seconds: float) -> list[Plan]:
    """The plans of a rival for the least distance, and for the fewest vehicles."""
    vehicle = LEGS_OF_VEHICLE * float(np.max(fleet.costs[0]))
    plans = (solve(fleet, cost, seconds) for cost in (0.0, vehicle))
    return [plan for plan in plans if plan is not None]
