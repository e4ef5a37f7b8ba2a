"""The kind of fronts of plans for several vehicles."""

from collections.abc import Callable
from typing import Any

from service.kinds.front_document import FrontDocument
from service.kinds.kind import Kind, Report, Tools
from service.requests.fleets.subject import UnmeasuredFleet
from service.requests.task import Task


def _outline(task: Task) -> tuple[int, dict[str, Any]]:
    assert isinstance(task.subject, UnmeasuredFleet)
    assert task.labels is not None
    return task.subject.n, task.subject.members(task.labels)


def _run(task: Task, tools: Tools, stop: Callable[[], bool], report: Report) -> FrontDocument:
    from service.kinds.fleet.run import run_fleet

    return run_fleet(task, tools, stop, report)


FLEET = Kind(name="fleet", of_plans=True, label="fleet", outline=_outline, run=_run)
