"""The kind of fronts of tours through stops or cities."""

from collections.abc import Callable
from typing import Any

from service.kinds.front_document import FrontDocument
from service.kinds.kind import Kind, Report, Tools
from service.requests.task import Task


def _outline(task: Task) -> tuple[int, dict[str, Any]]:
    stops = task.stops
    assert stops is not None
    labels = {} if task.labels is None else task.labels.members
    return stops.n, {"closed": None if stops.ends.closed else False, **labels}


def _run(task: Task, tools: Tools, stop: Callable[[], bool], report: Report) -> FrontDocument:
    from service.kinds.front.run import run_front

    return run_front(task, tools, stop, report)


FRONT = Kind(name="front", of_plans=False, label="tours", outline=_outline, run=_run)
