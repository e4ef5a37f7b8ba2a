"""The table of kinds of plans, and what it says of a task. A new kind gets a row."""

from collections.abc import Mapping
from typing import Any

from service.coverage.coverage import Coverage
from service.kinds.front_document import FrontDocument
from service.kinds.kind import Kind
from service.kinds.parts import (
    Part,
    parts_for_fleet,
    parts_for_map,
    parts_for_robots,
    parts_for_stops,
)
from service.requests.parser import read_coverage, read_fleet, read_front
from service.requests.replan.rest_of_fleet import rest_of_fleet
from service.requests.replan.rest_of_map import rest_of_map, rest_of_robots
from service.requests.replan.rest_of_stops import rest_of_stops
from service.requests.stops import Stops
from service.requests.task import KindName, SharedCoverage, Task, UnmeasuredFleet

_BRIEF = 5000  # preferences times cities


def _outline_of_front(stops: Stops, task: Task) -> tuple[int, dict[str, Any]]:
    labels = {} if task.labels is None else task.labels.members
    scale, default = stops.known_scale or (None, None)
    known = {} if scale is None or default is None else _of_scale(scale, default)
    return stops.n, {**known, "closed": None if stops.ends.closed else False, **labels}


def _of_scale(scale: Any, reference_point: Any) -> dict[str, Any]:
    return {"scale": scale.tolist(), "reference_point": reference_point.tolist()}


def _outline_of_coverage(coverage: Coverage, _: Task) -> tuple[int, dict[str, Any]]:
    places = _places_of(coverage)
    return len(places), {"places": places, "closed": None if coverage.ends.closed else False}


def _outline_of_robots(shared: SharedCoverage, _: Task) -> tuple[int, dict[str, Any]]:
    places = _places_of(shared.coverage)
    return len(places), {"places": places, **shared.members}


def _outline_of_fleet(fleet: UnmeasuredFleet, task: Task) -> tuple[int, dict[str, Any]]:
    assert task.labels is not None
    return fleet.n, fleet.members(task.labels)


def _places_of(coverage: Coverage) -> list[list[int]]:
    """Return row and column of the caller's places; none where a worker finds the places."""
    return [] if coverage.places is None else coverage.places.tolist()


_FRONT = Kind(
    name="front",
    path="front",
    subject=Stops,
    read=read_front,
    rest=rest_of_stops,
    planner=("service.kinds.tours", "run_front"),
    parts=parts_for_stops,
    outline=_outline_of_front,
    label="tours",
)
_COVERAGE = Kind(
    name="coverage",
    path="coverage",
    subject=Coverage,
    read=read_coverage,
    rest=rest_of_map,
    planner=("service.kinds.tours", "run_coverage"),
    parts=parts_for_map,
    outline=_outline_of_coverage,
    label="tours",
    stops="places",
    on_grid=True,
)
_FLEET = Kind(
    name="fleet",
    path="fleet",
    subject=UnmeasuredFleet,
    read=read_fleet,
    rest=rest_of_fleet,
    planner=("service.kinds.fleet", "run_fleet"),
    parts=parts_for_fleet,
    outline=_outline_of_fleet,
    label="fleet",
    item="plan",
    mover="vehicle",
    visits="stops",
)
_ROBOTS = Kind(
    name="robots",
    path="coverage",
    subject=SharedCoverage,
    read=read_coverage,
    rest=rest_of_robots,
    planner=("service.kinds.robots", "run_robots"),
    parts=parts_for_robots,
    outline=_outline_of_robots,
    label="robots",
    item="plan",
    mover="robot",
    stops="places",
    on_grid=True,
)
KINDS: Mapping[KindName, Kind[Any]] = {
    kind.name: kind for kind in (_FRONT, _COVERAGE, _FLEET, _ROBOTS)
}
_BY_SUBJECT = {kind.subject: kind for kind in KINDS.values()}


def kind_of(task: Task) -> Kind[Any]:
    """Return the kind of a task."""
    return _BY_SUBJECT[type(task.subject)]


def parts_of(task: Task) -> frozenset[Part]:
    """Return the parts of the compiled code that a task needs; none if the network does all."""
    parts = kind_of(task).parts(task.subject, task)
    return parts if task.options.bound else parts - {Part.BOUNDS}


def is_brief(task: Task) -> bool:
    """Return whether planning is one short call of a network: 50 ms or less with pa-one."""
    if task.stops is None or parts_of(task):
        return False
    short = len(task.options.directions) * task.stops.n <= _BRIEF
    return short and task.options.repairs == 0 and task.stops.measured


def empty_document(task: Task) -> FrontDocument:
    """Return the document of a task before anything has been found."""
    kind, point = kind_of(task), task.options.reference_point
    cities, members = kind.outline(task.subject, task)
    given = {} if point is None else {"reference_point": point.tolist()}
    known = {"scale": None, "reference_point": None, **members, **given}
    return FrontDocument(
        kind=kind.name,
        cities=cities,
        points=0,
        hypervolume=0.0,
        hypervolume_bound=None,
        timings_ms={},
        terminated=None,
        actor=None,
        **known,
    ).with_notes(task.notes)
