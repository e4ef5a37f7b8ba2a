"""The fields of a coverage request about several robots, and the task that they share."""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from service.coverage.coverage import Coverage, Robot
from service.errors import invalid
from service.fleet.fleet import Over
from service.instance import OBJECTIVES
from service.requests.maps.fields import ABSENT
from service.requests.schemas import NonNegativeInteger, Number, Text
from service.requests.validation import show

MOST_ROBOTS = 100
_METRES = {"sum": "total distance", "max": "longest route"}
_COSTS = {"sum": "total cost", "max": "greatest cost"}
DEFAULT_OVER: tuple[Over, Over] = ("sum", "max")
RobotPose = Annotated[list[Number], Field(min_length=2, max_length=3, fail_fast=True)]
OverBoth = Annotated[
    list[Over], Field(min_length=OBJECTIVES, max_length=OBJECTIVES, fail_fast=True)
]
# The fields that are about the tours of one robot, or about the network that builds them.
OF_ONE_ROBOT = (
    "start",
    "end",
    "start_pose",
    "end_pose",
    "initial_tours",
    "preferences",
    "repairs",
    "arrivals",
    "bound",
    "actor",
)
_ENDS = (("start", "start_pose"), ("end", "end_pose"))


class RobotItem(BaseModel):
    """A robot: where it starts and, where robots do not return, maybe where it ends."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    id: Text = Field(description="comes back with its routes; no two robots share one")
    start: NonNegativeInteger = Field(
        default=0, description="the place where it starts, which needs no other visit"
    )
    start_pose: RobotPose = Field(
        default_factory=list,
        description="instead of start: x and y, and maybe yaw, in the frame of the map",
    )
    end: NonNegativeInteger = Field(
        default=0, description="with closed false, the place where it ends; by default anywhere"
    )
    end_pose: RobotPose = Field(
        default_factory=list, description="instead of end: where it ends, in the frame of the map"
    )

    def robot(self, closed: bool) -> Robot:
        """Return the robot, which returns to its start where routes are closed."""
        given = self.model_fields_set
        return Robot(
            id=self.id,
            closed=closed,
            start=None if self.start_pose else self.start,
            end=self.end if "end" in given else None,
            start_pose=self.start_pose or None,
            end_pose=self.end_pose or None,
        )


@dataclass(frozen=True, eq=False)
class SharedCoverage:
    """A coverage task that robots share, and how the lengths of their routes are a plan's."""

    coverage: Coverage
    over: tuple[Over, Over]

    @property
    def members(self) -> dict[str, Any]:
        """The members of an answer that tell plans from tours: objectives, and open routes."""
        first, second = self.over
        closed = all(robot.closed for robot in self.coverage.robots)
        costs = {"name": _COSTS[second], "unit": None}
        metres = {"name": _METRES[second], "unit": "m"}
        return {
            "closed": None if closed else False,
            "objectives": [
                {"name": _METRES[first], "unit": "m", "over": first},
                {**(costs if self.coverage.has_costs else metres), "over": second},
            ],
        }


def check_robots(
    robots: Sequence[RobotItem], over: Sequence[Over], given: Set[str], closed: bool
) -> None:
    """Raise a refusal where robots, of a request with these fields, contradict it or each other.

    Raises:
        Refusal: A field is about one robot, two robots share an id, one has two starts or two ends,
            or an end and returns to its start; or both lengths are those of longest routes.
    """
    if "over" in given and not robots:
        raise invalid("over", "is for several robots, and none are given")
    if not robots:
        return
    for name in OF_ONE_ROBOT:
        if name in given:
            raise invalid(name, "must be left out with robots, whose routes are planned together")
    if list(over) == ["max", "max"]:
        raise invalid("over/1", "must be sum, as over/0 is max, got max")
    first: dict[str, int] = {}
    for index, robot in enumerate(robots):
        if (other := first.setdefault(robot.id, index)) != index:
            demand = f"must not be that of robots/{other}, got {show(robot.id)} twice"
            raise invalid(f"robots/{index}/id", demand)
        _check_ends(robot, f"robots/{index}", closed)


def _check_ends(robot: RobotItem, part: str, closed: bool) -> None:
    given = robot.model_fields_set
    for place, pose in _ENDS:
        if place in given and pose in given:
            raise invalid(f"{part}/{pose}", f"or {place} must be left out")
    for name in ("end", "end_pose"):
        if closed and name in given:
            raise invalid(f"{part}/{name}", "is for open routes, with closed false")


def describe_robots(schema: Mapping[str, Any], most_places: int) -> None:
    """Refine the field of robots in the JSON schema of a request, and put their own in it."""
    robot: dict[str, Any] = schema["$defs"][RobotItem.__name__]
    for name in ("start", "end"):
        robot["properties"][name]["maximum"] = most_places - 1
    del robot["properties"]["end"]["default"]
    robot["dependentSchemas"] = {place: {"properties": {pose: ABSENT}} for place, pose in _ENDS}
    schema["properties"]["robots"]["items"] = robot


def rules_of_robots() -> dict[str, Any]:
    """Return the rules of a request with robots, as dependentSchemas."""
    return {
        "robots": {"properties": dict.fromkeys(OF_ONE_ROBOT, ABSENT)},
        "over": {"required": ["robots"]},
    }
