"""The robots that share a coverage task: where each starts and where it ends."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from service.instance import RouteEnds


@dataclass(frozen=True, kw_only=True)
class Robot:
    """A robot with a start of its own.

    Args:
        id: The name that comes back with its routes.
        closed: Whether it returns to its start.
        start: The place where it starts.
        end: The place where it ends, if it does not return; None where that may be any.
        start_pose: Instead of the start, x and y in the frame of the map, and maybe more, which is
            disregarded: a place of its own, if none is there.
        end_pose: Instead of the end, likewise.
    """

    id: str
    closed: bool = True
    start: int | None = None
    end: int | None = None
    start_pose: Sequence[float] | None = None
    end_pose: Sequence[float] | None = None

    def ends(self, part: str, poses: Mapping[str, int]) -> RouteEnds:
        """Return the places where it starts and ends.

        Args:
            part: Its part of the request, as robots/0.
            poses: The place of each pose, by its part, as robots/0/start_pose.
        """
        start = poses.get(f"{part}/start_pose", self.start)
        return RouteEnds(self.closed, start, poses.get(f"{part}/end_pose", self.end))


def parts_of(robots: Sequence[Robot]) -> Iterator[tuple[str, Robot]]:
    """Yield each robot with its part of a request, as robots/0."""
    return ((f"robots/{index}", robot) for index, robot in enumerate(robots))


def poses_of(robots: Sequence[Robot]) -> dict[str, Sequence[float]]:
    """Return the poses at which robots start and end by their parts, as far as they are given."""
    poses = {
        f"{part}/{name}": pose
        for part, robot in parts_of(robots)
        for name, pose in (("start_pose", robot.start_pose), ("end_pose", robot.end_pose))
    }
    return {name: pose for name, pose in poses.items() if pose is not None}
