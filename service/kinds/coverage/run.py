"""Plan the front of a robot's tours over a map."""

import time
from collections.abc import Callable
from dataclasses import replace

from service.coverage.coverage import Coverage
from service.coverage.frame import CoveragePath
from service.coverage.survey import Survey, survey
from service.errors import Cancelled
from service.front import Front
from service.kinds.front_document import FrontDocument
from service.kinds.kind import Report, Tools
from service.kinds.tour_document import encode_front
from service.kinds.tours import arrivals_of, plan_tours
from service.requests.limits import Limits, within_network
from service.requests.parser import check_instance
from service.requests.task import Task


def run_coverage(
    task: Task, tools: Tools, stop: Callable[[], bool], report: Report
) -> FrontDocument:
    """Return the front of a task; see `Run`."""
    assert isinstance(task.subject, Coverage)
    limits = tools.limits
    began = time.perf_counter()
    surveyed = survey(task.subject, limits.most_places(shared=False), stop)
    check_instance(task, surveyed.instance)
    surveyed_at = time.perf_counter()
    options = within_network(task.options, surveyed.instance.n, limits)
    task = replace(task, options=replace(options, start=surveyed.start))
    front = plan_tours(task, surveyed.instance, tools, stop, report, surveyed)
    planned_at = time.perf_counter()
    paths = _paths(surveyed, front, limits, stop) if task.paths else None
    timings = {
        "survey": 1000 * (surveyed_at - began),
        **front.timings,
        "paths": 1000 * (time.perf_counter() - planned_at),
    }
    return encode_front(
        replace(front, timings=timings),
        tools.actors[task.actor].info.identity,
        surveyed,
        paths,
        arrivals=arrivals_of(task, surveyed.instance, front),
    )


def _paths(
    surveyed: Survey, front: Front, limits: Limits, stop: Callable[[], bool]
) -> list[CoveragePath] | None:
    """Return the path of each tour; None if the task is stopped before."""
    try:
        return list(surveyed.paths(front.tours, limits.path_cells, stop))
    except Cancelled:
        return None
