"""The kind of fronts of plans for several robots on a map."""

from collections.abc import Callable
from typing import Any

from service.kinds.coverage.kind import places_of
from service.kinds.front_document import FrontDocument
from service.kinds.kind import Kind, Report, Tools
from service.requests.maps.robots import SharedCoverage
from service.requests.task import Task


def _outline(task: Task) -> tuple[int, dict[str, Any]]:
    assert isinstance(task.subject, SharedCoverage)
    places = places_of(task.subject.coverage)
    return len(places), {"places": places, **task.subject.members}


def _run(task: Task, tools: Tools, stop: Callable[[], bool], report: Report) -> FrontDocument:
    from service.kinds.robots.run import run_robots

    return run_robots(task, tools, stop, report)


ROBOTS = Kind(name="robots", of_plans=True, label="robots", outline=_outline, run=_run)
