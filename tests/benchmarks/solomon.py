"""`python -m tests.benchmarks solomon --data FOLDER`: fleets with time windows, of Solomon's.

Distance against the longest route, which is the time that a vehicle is on its way, with service and
waiting. Reads every .txt file of a folder in Solomon's format, as CVRPLIB has them, and beside it
the best known distance from a .sol file. Distances are cut off after the first decimal, as these
are. The plain sweep is PyVRP from scratch under twelve limits, in the same time altogether. Both
run on one thread, and every plan is checked. The hypervolume is that in the box of both fronts.

Prints a table, and stores `results/solomon.json`; what is stored is not measured again.
"""

import argparse
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import vrplib

from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.planner import plan_fleet
from service.fleet.plans import Plan
from service.fleet.rules import Rules
from service.fleet.translation import Translation
from service.fleet.vehicles import VehicleType, Visit
from tests.benchmarks.fleet import swept
from tests.benchmarks.fleet_fronts import Find, timed_front
from tests.benchmarks.fleet_table import OURS, PLAIN
from tests.benchmarks.rows import resume
from tests.benchmarks.solomon_table import solomon_table

SECONDS = 10.0


class Solomon(NamedTuple):
    """A fleet of Solomon's, and the best known total distance."""

    fleet: Fleet
    best_known: float


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks solomon", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="holds .txt and .sol files")
    parser.add_argument("--names", nargs="+", help="of instances; by default all in the folder")
    options = parser.parse_args(arguments)
    for path in sorted(options.data.glob("*.txt")):
        if options.names is None or path.stem in options.names:
            for method, find in ((OURS, ours), (PLAIN, plainly)):
                key = f"{path.stem}, {method}"
                resume("solomon", key, "", [read_solomon(path)], partial(measured, find))
    print(solomon_table())


def read_solomon(path: Path) -> Solomon:
    """A file of Solomon's, with the one beside it."""
    read = vrplib.read_instance(path, instance_format="solomon", compute_edge_weights=False)
    places = np.array(read["node_coord"], float)
    distances = np.linalg.norm(places[:, np.newaxis] - places, axis=2)
    costs = np.floor(10 * distances + 1e-9) / 10
    customers = zip(read["demand"], read["service_time"], read["time_window"], strict=True)
    depot, *visits = [
        Visit(demand=(int(demand),), service=float(service), windows=((opens, closes),))
        for demand, service, (opens, closes) in customers
    ]
    vehicle = VehicleType(
        start=0,
        end=0,
        count=int(read["vehicles"]),
        capacity=(int(read["capacity"]),),
        shift=depot.windows[0],
    )
    rules = Rules(visits=(Visit(), *visits), vehicles=(vehicle,), over=("sum", "max"), clock=1)
    known = vrplib.read_solution(path.with_suffix(".sol"))
    return Solomon(Fleet(rules=rules, costs=np.stack([costs, costs])), float(known["cost"]))


def measured(find: Find, instance: Solomon) -> dict[str, Any]:
    """Seconds, the points of the plans found, and the best known distance."""
    seconds, points = timed_front(find, instance.fleet, SECONDS)
    points = np.unique(points, axis=0).round(3)
    return {"seconds": seconds, "best_known": instance.best_known, "points": points.tolist()}


def ours(fleet: Fleet, seconds: float) -> list[Plan]:
    """The plans of this project."""
    return list(plan_fleet(fleet, FleetOptions(time_limit=seconds)).plans)


def plainly(fleet: Fleet, seconds: float) -> list[Plan]:
    """The plans of PyVRP from scratch, under limits down to the longest way to one customer."""
    alone = fleet.costs[1, 0] + fleet.costs[1, :, 0]
    service = np.array([visit.service for visit in fleet.rules.visits])
    return swept(Translation(fleet), float((alone + service).max()), seconds)
