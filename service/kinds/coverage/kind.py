"""The kind of fronts of a robot's tours over a map."""

from collections.abc import Callable
from typing import Any

from service.coverage.coverage import Coverage
from service.kinds.front_document import FrontDocument
from service.kinds.kind import Kind, Report, Tools
from service.requests.task import Task


def places_of(coverage: Coverage) -> list[list[int]]:
    """Return row and column of the caller's places; none where a worker finds the places."""
    return [] if coverage.places is None else coverage.places.tolist()


def _outline(task: Task) -> tuple[int, dict[str, Any]]:
    assert isinstance(task.subject, Coverage)
    places = places_of(task.subject)
    closed = None if task.subject.ends.closed else False
    return len(places), {"places": places, "closed": closed}


def _run(task: Task, tools: Tools, stop: Callable[[], bool], report: Report) -> FrontDocument:
    from service.kinds.coverage.run import run_coverage

    return run_coverage(task, tools, stop, report)


COVERAGE = Kind(name="coverage", of_plans=False, label="tours", outline=_outline, run=_run)
