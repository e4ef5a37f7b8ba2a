"""Robots that share the places of a map as a fleet: its stops, and its plans as routes on the map.

The place where a robot starts is visited by it, so starts are depots. The place where a robot ends
must be visited too, maybe by another robot. So such a place becomes two stops in the same cell: the
end of the robot, and a stop to visit.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.coverage.survey import Survey
from service.fleet.fleet import Fleet, Over, Rules, VehicleType, Visit
from service.fleet.plans import Plan, Route, path_of

Indices = NDArray[np.int64]


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
        places = self.places[list(path_of(self.fleet.rules, route))]
        moves = np.append(True, places[1:] != places[:-1])
        return places[moves]


def robot_fleet(surveyed: Survey, over: tuple[Over, Over]) -> RobotFleet:
    """Return the fleet of the robots of a survey; `over` is that of its two objectives."""
    assert surveyed.instance.matrices is not None
    places, types = _stops_and_types(surveyed)
    vehicles = tuple(
        VehicleType(start=start, end=end, count=len(robots))
        for (start, end), robots in types.items()
    )
    rules = Rules(visits=(Visit(),) * len(places), vehicles=vehicles, over=over)
    costs = surveyed.instance.matrices[:, places[:, np.newaxis], places]
    return RobotFleet(Fleet(rules=rules, costs=costs), places, list(types.values()))


def _stops_and_types(
    surveyed: Survey,
) -> tuple[Indices, dict[tuple[int, int | None], list[int]]]:
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
