"""Plan fronts of plans for several robots on a map, and write them as JSON.

The robots are the vehicles of a fleet, and its stops are places of the map. The place where a robot
starts is visited by that robot, so starts are depots. The place where a robot ends must be visited
too, maybe by another robot. So such a place becomes two stops in the same cell: the end of the
robot, and a stop to visit.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import repeat
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from service.coverage.coverage import Robot
from service.coverage.frame import CoveragePath
from service.coverage.survey import Survey, survey
from service.fleet.evaluation import route_lengths
from service.fleet.fleet import Fleet
from service.fleet.plans import FleetFront, Plan, Route, path_of
from service.fleet.rules import Rules
from service.fleet.schedule import schedule
from service.fleet.vehicles import VehicleType, Visit
from service.kinds.fleet import document_of_plans, plan_front
from service.kinds.front_document import FrontDocument, encode_path, with_member
from service.kinds.kind import Tools
from service.kinds.map_day import costs_of_day
from service.kinds.tour_document import on_map
from service.kinds.tours import seconds_to_survey, unless_cancelled
from service.requests.task import SharedCoverage, Task
from service.watch import Watch

Indices = NDArray[np.int64]


def run_robots(
    subject: SharedCoverage, task: Task, tools: Tools, watch: Watch[FrontDocument]
) -> FrontDocument:
    """Return the front of plans of a task; see `Run`."""
    actor, limits = tools.actors.get(task.actor), tools.limits
    began = watch.spent
    most, seconds = limits.most_places(shared=True), seconds_to_survey(task, limits)
    surveyed = survey(subject.coverage, most, watch.stopped, seconds)
    fleet = robot_fleet(surveyed, subject)
    known = {**on_map(surveyed), **subject.members}

    def encoded(front: FleetFront, paths: Iterable[CoveragePath] | None = None) -> FrontDocument:
        each = repeat(None) if paths is None else iter(paths)
        return document_of_plans(
            front,
            lambda plan, members: _encode_plan(fleet, plan, members, subject.coverage.robots, each),
            actor,
            kind="robots",
            cities=len(surveyed.places),
            **known,
        )

    surveyed_at = watch.spent
    front = plan_front(task, fleet.fleet, actor, watch.converting(encoded))
    planned_at = watch.spent
    paths = None
    if task.paths:
        plans = [[fleet.way(route) for route in plan.routes] for plan in front.plans]
        paths = unless_cancelled(surveyed.paths_of_plans(plans, limits.path_cells, watch.stopped))
    timings = {
        "survey": 1000 * (surveyed_at - began),
        **front.timings,
        "paths": 1000 * (watch.spent - planned_at),
    }
    return encoded(replace(front, timings=timings), paths)


@dataclass(frozen=True, eq=False)
class RobotFleet:
    """A fleet of robots on a map.

    Args:
        fleet: The fleet, with one type of vehicles for all robots with the same start and end.
        places: The place of each stop, shape (n,).
        robots: The robots of each type, by their indexes.
    """

    fleet: Fleet
    places: Indices
    robots: Sequence[Sequence[int]]

    def routes(self, plan: Plan) -> Iterator[tuple[int, Route]]:
        """Yield each route of a plan with its robot: the next free one of its type."""
        free = [iter(robots) for robots in self.robots]
        return ((next(free[route.vehicle]), route) for route in plan.routes)

    def way(self, route: Route) -> Indices:
        """Return the places of a route in order, from its start to its end if it has one."""
        places = self._places_of(route)
        return places[_moves(places)]

    def times(self, route: Route) -> list[float]:
        """Return when the robot is at each place of `way`; the fleet has a clock."""
        arrivals = np.array(schedule(self.fleet, route).arrivals)
        return arrivals[_moves(self._places_of(route))].tolist()

    def _places_of(self, route: Route) -> Indices:
        return self.places[list(path_of(self.fleet.rules, route))]


def _moves(places: Indices) -> NDArray[np.bool_]:
    """Return at which of some places a robot has not been just before."""
    return np.append(True, places[1:] != places[:-1])


def robot_fleet(surveyed: Survey, shared: SharedCoverage) -> RobotFleet:
    """Return the fleet of the robots of a survey."""
    assert surveyed.instance.matrices is not None
    places, types = _stops_and_types(surveyed)
    costs = surveyed.instance.matrices[:, places[:, np.newaxis], places]
    vehicles = [
        VehicleType(start=start, end=end, count=len(robots))
        for (start, end), robots in types.items()
    ]
    visits, hours = (Visit(),) * len(places), shared.coverage.hours
    if hours is None:
        rules = Rules(visits=visits, vehicles=tuple(vehicles), over=shared.over)
        return RobotFleet(Fleet(rules=rules, costs=costs), places, list(types.values()))
    seconds, *further = costs_of_day(hours, costs)
    rules = Rules(
        visits=visits,
        vehicles=tuple(
            replace(vehicle, shift=(hours.earliest, inf), leaves_by=hours.latest)
            for vehicle in vehicles
        ),
        over=shared.over,
        layers=(0, len(further)),
        clock=0,
    )
    fleet = Fleet.over_the_day(rules, seconds, *(further or [seconds]))
    return RobotFleet(fleet, places, list(types.values()))


def _stops_and_types(surveyed: Survey) -> tuple[Indices, dict[tuple[int, int | None], list[int]]]:
    """Return the place of each stop, and the robots of each pair of stops to start and end at."""
    starts = {ends.start for ends in surveyed.robots}
    places = list(range(len(surveyed.places)))
    types: dict[tuple[int, int | None], list[int]] = {}
    own_stops: dict[int, int] = {}  # by place, the second stop where a robot ends
    for robot, (closed, start, end) in enumerate(surveyed.robots):
        assert start is not None
        if end is not None and end < surveyed.to_visit and end not in starts:
            if end not in own_stops:
                own_stops[end] = len(places)
                places.append(end)
            end = own_stops[end]
        types.setdefault((start, start if closed else end), []).append(robot)
    return np.array(places, np.int64), types


def _encode_plan(
    fleet: RobotFleet,
    plan: Plan,
    members: Mapping[str, Any],
    robots: Sequence[Robot],
    paths: Iterator[CoveragePath | None],
) -> bytes:
    """Return a plan as JSON; the paths of its routes are the next ones, if there are any."""
    routes = []
    for robot, route in fleet.routes(plan):
        content = {
            "robot": robots[robot].id,
            "tour": fleet.way(route).tolist(),
            "lengths": list(route_lengths(fleet.fleet, route)),
        }
        if fleet.fleet.rules.clock is not None:
            content["times"] = fleet.times(route)
        encoded, path = to_json(content), next(paths)
        routes.append(encoded if path is None else with_member(encoded, b"path", encode_path(path)))
    return with_member(to_json(members), b"routes", b"[" + b",".join(routes) + b"]")
