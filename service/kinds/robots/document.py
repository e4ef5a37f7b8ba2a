"""A front of plans for robots as JSON: routes through the places of a map, and their paths."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import repeat
from typing import Any

from pydantic_core import to_json

from service.coverage.frame import CoveragePath
from service.coverage.survey import Survey
from service.fleet.evaluation import route_lengths
from service.fleet.plans import FleetFront, Plan, Route
from service.kinds.fleet.document import document_of_plans
from service.kinds.front_document import FrontDocument
from service.kinds.json_parts import encode_path, with_member
from service.kinds.robots.as_fleet import RobotFleet
from service.kinds.tour_document import on_map
from service.requests.maps.robots import SharedCoverage

Paths = Iterator[CoveragePath | None]


@dataclass(frozen=True, eq=False)
class RobotEncoder:
    """Writes fronts of plans for the robots of a task as JSON, once its places are surveyed."""

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
                any.
            paths: The path of each route of each plan, if the task asks for them.
        """
        each: Paths = repeat(None) if paths is None else iter(paths)
        return document_of_plans(
            front,
            lambda plan, members: self._plan(plan, members, each),
            kind="robots",
            cities=len(self.surveyed.places),
            actor=actor,
            members={**on_map(self.surveyed), **self.subject.members},
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
