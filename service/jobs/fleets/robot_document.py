"""A front of plans for robots as JSON: routes through the places of a map, and their paths."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import repeat
from typing import Any

from pydantic_core import to_json

from service.coverage.coverage import Coverage
from service.coverage.survey import CoveragePath, Survey
from service.fleet.evaluation import route_lengths
from service.fleet.plans import FleetFront, Plan, Route
from service.jobs.fleets.fleet_document import directions
from service.jobs.fleets.robot_fleet import RobotFleet
from service.jobs.front_document import FrontDocument, Timings, empty_front, on_map
from service.jobs.json_parts import encode_path, joined, with_member
from service.pareto import balances
from service.requests.maps.robots import SharedCoverage
from service.requests.task import Task

_METRES = {"sum": "total distance", "max": "longest route"}
_COSTS = {"sum": "total cost", "max": "greatest cost"}
Paths = Iterator[CoveragePath | None]


@dataclass(frozen=True, eq=False)
class RobotEncoder:
    """Writes fronts of plans for the robots of a task, whose places are surveyed, as JSON."""

    subject: SharedCoverage
    surveyed: Survey
    fleet: RobotFleet

    def encode(
        self,
        front: FleetFront,
        actor: Mapping[str, str] | None,
        paths: Iterable[CoveragePath] | None = None,
    ) -> FrontDocument:
        """Write a front.

        Args:
            front: The front.
            actor: The name and digest of the network whose tours were cut into the first plans, if
                so.
            paths: The path of each route of each plan, where the task asks for them.
        """
        each: Paths = repeat(None) if paths is None else iter(paths)
        members = zip(balances(front.points).tolist(), front.points.tolist(), strict=True)
        plans, ends = joined(
            self._plan(plan, {"balance": balance, "lengths": lengths}, each)
            for plan, (balance, lengths) in zip(front.plans, members, strict=True)
        )
        return FrontDocument(
            cities=len(self.surveyed.places),
            points=front.found,
            hypervolume=front.hypervolume,
            hypervolume_bound=None,
            reference_point=front.reference_point.tolist(),
            scale=front.scale.tolist(),
            timings_ms=Timings(front.timings),
            terminated=front.terminated,
            actor=actor,
            **on_map(self.surveyed),
            **_kind_of_plans(self.subject),
            tours=plans,
            ends=ends,
            angles=directions(front).tobytes(),
        )

    def _plan(self, plan: Plan, members: Mapping[str, Any], paths: Paths) -> bytes:
        routes = [
            self._route(robot, route, next(paths)) for robot, route in self.fleet.routes(plan)
        ]
        return with_member(to_json(members), b"routes", b"[" + b",".join(routes) + b"]")

    def _route(self, robot: int, route: Route, path: CoveragePath | None) -> bytes:
        members = {
            "robot": self.subject.coverage.robots[robot].id,
            "tour": self.fleet.way(route).tolist(),
            "lengths": list(route_lengths(self.fleet.fleet, route)),
        }
        encoded = to_json(members)
        return encoded if path is None else with_member(encoded, b"path", encode_path(path))


def empty_robot_plans(task: Task, subject: SharedCoverage) -> FrontDocument:
    """Return the document of a task for robots before anything is found."""
    of_one_robot = empty_front(replace(task, subject=subject.coverage))
    return replace(of_one_robot, **_kind_of_plans(subject))


def _kind_of_plans(subject: SharedCoverage) -> dict[str, Any]:
    """Return the members of a document that only plans have: objectives, and open routes."""
    first, second = subject.over
    return {
        "closed": None if _returns(subject.coverage) else False,
        "objectives": [
            {"name": _METRES[first], "unit": "m", "over": first},
            {**_second_objective(subject.coverage, second), "over": second},
        ],
    }


def _second_objective(coverage: Coverage, over: str) -> dict[str, str | None]:
    if coverage.has_costs:
        return {"name": _COSTS[over], "unit": None}
    return {"name": _METRES[over], "unit": "m"}


def _returns(coverage: Coverage) -> bool:
    return all(robot.closed for robot in coverage.robots)
