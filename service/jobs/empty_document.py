"""The front of a task of which nothing has been found yet."""

from typing import Any

from service.coverage.coverage import Coverage
from service.jobs.front_document import FrontDocument, Timings
from service.requests.fleets.subject import UnmeasuredFleet
from service.requests.maps.robots import SharedCoverage
from service.requests.stops import Stops
from service.requests.task import Task


def empty_document(task: Task) -> FrontDocument:
    """Return the document of a task, of tours or of plans, of which nothing has been found yet.

    A worker finds out later how many places a map has, and what they cost.
    """
    reference_point, scale = task.options.reference_point, None
    if isinstance(task.subject, Stops) and task.subject.measured:
        instance = task.subject.instance
        scale = instance.scale.tolist()
        if reference_point is None:
            reference_point = instance.reference_point
    cities, members = _cities_and_members(task)
    return FrontDocument(
        cities=cities,
        points=0,
        hypervolume=0.0,
        hypervolume_bound=None,
        reference_point=None if reference_point is None else reference_point.tolist(),
        scale=scale,
        timings_ms=Timings({}),
        terminated=None,
        actor=None,
        **members,
    )


def _cities_and_members(task: Task) -> tuple[int, dict[str, Any]]:
    """Return the number of cities, and the members that tell what is planned."""
    labels = {} if task.labels is None else task.labels.members
    match task.subject:
        case UnmeasuredFleet() as fleet:
            assert task.labels is not None
            return fleet.n, fleet.members(task.labels)
        case SharedCoverage() as shared:
            places = _places(shared.coverage)
            return len(places), {"places": places, **shared.members}
        case Coverage() as coverage:
            places = _places(coverage)
            return len(places), {"places": places, "closed": _closed(coverage), **labels}
        case Stops() as stops:
            return stops.n, {"closed": _closed(stops), **labels}


def _places(coverage: Coverage) -> list[list[int]]:
    return [] if coverage.places is None else coverage.places.tolist()


def _closed(subject: Coverage | Stops) -> bool | None:
    """Return the member `closed`, which is left out where tours are closed."""
    return None if subject.ends.closed else False
