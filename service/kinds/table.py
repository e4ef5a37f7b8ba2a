"""The table of kinds of plans. A new kind gets a row here, and one in the table of `run`."""

from collections.abc import Mapping
from typing import Any

from service.coverage.coverage import Coverage
from service.kinds.front_document import FrontDocument
from service.kinds.kind import Kind
from service.requests.stops import Stops
from service.requests.task import KindName, SharedCoverage, Task, UnmeasuredFleet


def _outline_of_front(task: Task) -> tuple[int, dict[str, Any]]:
    assert isinstance(task.subject, Stops)
    labels = {} if task.labels is None else task.labels.members
    return task.subject.n, {"closed": None if task.subject.ends.closed else False, **labels}


def _outline_of_coverage(task: Task) -> tuple[int, dict[str, Any]]:
    assert isinstance(task.subject, Coverage)
    places = _places_of(task.subject)
    closed = None if task.subject.ends.closed else False
    return len(places), {"places": places, "closed": closed}


def _outline_of_robots(task: Task) -> tuple[int, dict[str, Any]]:
    assert isinstance(task.subject, SharedCoverage)
    places = _places_of(task.subject.coverage)
    return len(places), {"places": places, **task.subject.members}


def _outline_of_fleet(task: Task) -> tuple[int, dict[str, Any]]:
    assert isinstance(task.subject, UnmeasuredFleet)
    assert task.labels is not None
    return task.subject.n, task.subject.members(task.labels)


def _places_of(coverage: Coverage) -> list[list[int]]:
    """Return row and column of the caller's places; none where a worker finds the places."""
    return [] if coverage.places is None else coverage.places.tolist()


KINDS: Mapping[KindName, Kind] = {
    kind.name: kind
    for kind in (
        Kind(name="front", of_plans=False, label="tours", outline=_outline_of_front),
        Kind(name="coverage", of_plans=False, label="tours", outline=_outline_of_coverage),
        Kind(name="fleet", of_plans=True, label="fleet", outline=_outline_of_fleet),
        Kind(name="robots", of_plans=True, label="robots", outline=_outline_of_robots),
    )
}


def empty_document(task: Task) -> FrontDocument:
    """Return the document of a task before anything has been found."""
    known = task.subject.known_scale if isinstance(task.subject, Stops) else None
    scale, default = (None, None) if known is None else known
    reference_point = (
        default if task.options.reference_point is None else task.options.reference_point
    )
    cities, members = KINDS[task.kind].outline(task)
    return FrontDocument(
        kind=task.kind,
        cities=cities,
        points=0,
        hypervolume=0.0,
        hypervolume_bound=None,
        reference_point=None if reference_point is None else reference_point.tolist(),
        scale=None if scale is None else scale.tolist(),
        timings_ms={},
        terminated=None,
        actor=None,
        **members,
    ).with_notes(task.notes)
