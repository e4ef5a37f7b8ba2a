"""The table of kinds of plans. A new kind gets a row here, and a folder beside this module."""

from collections.abc import Mapping

from service.kinds.coverage.kind import COVERAGE
from service.kinds.fleet.kind import FLEET
from service.kinds.front.kind import FRONT
from service.kinds.front_document import FrontDocument, Timings
from service.kinds.kind import Kind
from service.kinds.robots.kind import ROBOTS
from service.requests.task import KindName, Task

KINDS: Mapping[KindName, Kind] = {kind.name: kind for kind in (FRONT, COVERAGE, FLEET, ROBOTS)}


def empty_document(task: Task) -> FrontDocument:
    """Return the document of a task before anything has been found."""
    reference_point, scale = task.options.reference_point, None
    if (instance := task.known_instance) is not None:
        scale = instance.scale.tolist()
        reference_point = instance.reference_point if reference_point is None else reference_point
    cities, members = KINDS[task.kind].outline(task)
    return FrontDocument(
        kind=task.kind,
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
