"""Plan the front of several robots that share a map."""

import time
from collections.abc import Callable
from dataclasses import replace

from service.coverage.frame import CoveragePath
from service.coverage.survey import Survey, survey
from service.errors import Cancelled
from service.fleet.plans import FleetFront
from service.front import reporting
from service.kinds.fleet.run import identity_of, plan_front
from service.kinds.front_document import FrontDocument
from service.kinds.kind import Report, Tools
from service.kinds.robots.as_fleet import RobotFleet, robot_fleet
from service.kinds.robots.document import RobotEncoder
from service.requests.maps.robots import SharedCoverage
from service.requests.task import Task


def run_robots(task: Task, tools: Tools, stop: Callable[[], bool], report: Report) -> FrontDocument:
    """Return the front of plans of a task; see `Run`."""
    subject, actor, limits = task.subject, tools.actors.get(task.actor), tools.limits
    assert isinstance(subject, SharedCoverage)
    began = time.perf_counter()
    surveyed = survey(subject.coverage, limits.most_places(shared=True), stop)
    fleet = robot_fleet(surveyed, subject.over)
    encoder = RobotEncoder(subject, surveyed, fleet)

    def encoded(front: FleetFront) -> FrontDocument:
        return encoder.encode(front, identity_of(front, actor))

    surveyed_at = time.perf_counter()
    front = plan_front(task, fleet.fleet, actor, stop, reporting(report, encoded))
    planned_at = time.perf_counter()
    paths = _paths(surveyed, fleet, front, limits.path_cells, stop) if task.paths else None
    timings = {
        "survey": 1000 * (surveyed_at - began),
        **front.timings,
        "paths": 1000 * (time.perf_counter() - planned_at),
    }
    return encoder.encode(replace(front, timings=timings), identity_of(front, actor), paths)


def _paths(
    surveyed: Survey,
    fleet: RobotFleet,
    front: FleetFront,
    most_cells: int,
    stop: Callable[[], bool],
) -> list[CoveragePath] | None:
    """Return the path of each route; None if the task is stopped."""
    plans = [[fleet.way(route) for route in plan.routes] for plan in front.plans]
    try:
        return list(surveyed.paths_of_plans(plans, most_cells, stop))
    except Cancelled:
        return None
