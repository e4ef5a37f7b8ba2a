"""The table of kinds of plans. A new kind gets a row here, and a folder beside this module."""

from collections.abc import Mapping

from service.kinds.coverage.kind import COVERAGE
from service.kinds.fleet.kind import FLEET
from service.kinds.front.kind import FRONT
from service.kinds.front_document import FrontDocument, Timings
from service.kinds.kind import Kind
from service.kinds.robots.kind import ROBOTS
from service.requests.stops import Stops
from service.requests.task import KindName, Task

KINDS: Mapping[KindName, Kind] = {kind.name: kind for kind in (FRONT, COVERAGE, FLEET, ROBOTS)}


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
        timings_ms=Timings({}),
        terminated=None,
        actor=None,
        **members,
    )
