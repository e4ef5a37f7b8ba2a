"""The fields of a coverage request about several robots, and their checks."""

from collections.abc import Sequence, Set
from typing import Annotated

from pydantic import Field

from service.coverage.robots import Robot
from service.errors import invalid
from service.fleet.fleet import Over
from service.requests.fields import NonNegativeInteger, Number, OneEach, StrictModel, Text
from service.requests.stop_fields import check_unique

MOST_ROBOTS = 100
DEFAULT_OVER: tuple[Over, Over] = ("sum", "max")
RobotPose = Annotated[list[Number], Field(min_length=2, max_length=3, fail_fast=True)]
OverBoth = OneEach[Over]
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
ENDS = (("start", "start_pose"), ("end", "end_pose"))


class RobotItem(StrictModel):
    """A robot: where it starts and, where robots do not return, maybe where it ends."""

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


def check_robots(
    robots: Sequence[RobotItem], over: Sequence[Over], given: Set[str], closed: bool
) -> None:
    """Raise a refusal where the robots of a request contradict its other fields, or each other.

    Raises:
        Refusal: A field is for a single robot; two robots share an id; a robot has two starts, two
            ends, or an end although it returns to its start; or both lengths are of longest routes.
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
    check_unique([robot.id for robot in robots], "robots")
    for index, robot in enumerate(robots):
        _check_ends(robot, f"robots/{index}", closed)


def _check_ends(robot: RobotItem, part: str, closed: bool) -> None:
    given = robot.model_fields_set
    for place, pose in ENDS:
        if place in given and pose in given:
            raise invalid(f"{part}/{pose}", f"or {place} must be left out")
    for name in ("end", "end_pose"):
        if closed and name in given:
            raise invalid(f"{part}/{name}", "is for open routes, with closed false")
