"""Write paths over a map for robots: as poses, as messages nav_msgs/Path, and as CSV."""

import csv
import io
from collections import defaultdict
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from paretour.described import Array, Shape, answer, member

PAIR = 2  # numbers: of a cell, a point or a length under two objectives
Pairs = Annotated[NDArray[np.int64], Shape(None, PAIR)]
_COLUMNS = ("x", "y", "yaw", "place")


@answer("PathItem", kw_only=False)
class Path:
    """A way over the map, through all places in the order of a tour."""

    cells: Pairs = member("row and column of each; a closed tour ends with its first cell")
    metres: float = member("its length")
    points: Annotated[Array, Shape("cells", PAIR)] | None = member(
        "x and y of each cell's middle in the frame of the map, in metres, if its origin is known",
        default=None,
    )
    yaws: Annotated[Array, Shape("cells")] | None = member(
        "with points: the direction in radians in which the robot leaves each cell, and at the last"
        " cell the one in which it arrives",
        default=None,
    )
    visits: Pairs | None = member(
        "for each place of the tour in order, back to the first if it is closed: the index of its"
        " cell in cells, and the place; all other cells are on the way",
        default=None,
    )

    @property
    def poses(self) -> Array:
        """x, y and yaw at each cell in the frame of the map, shape (m, 3).

        Raises:
            ValueError: The origin of the map is not known.
        """
        if self.points is None or self.yaws is None:
            raise ValueError("a path has poses only on a map with an origin")
        return np.column_stack((self.points, self.yaws))

    def to_nav_path(self, frame_id: str = "map") -> dict[str, Any]:
        """Return a message nav_msgs/Path of ROS 2 with a pose for each cell, ready for JSON.

        All stamps are zero, which is the latest transform.

        Args:
            frame_id: The name of the frame of the map.

        Raises:
            ValueError: The origin of the map is not known.
        """
        header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": frame_id}
        poses = [{"header": header, "pose": _pose(x, y, yaw)} for x, y, yaw in self.poses.tolist()]
        return {"header": header, "poses": poses}

    def to_csv(self) -> str:
        """Return CSV with a row for each cell: x and y in metres, yaw in radians, and the place.

        The place is empty on the way. Two places in one cell have a space between.

        Raises:
            ValueError: The origin of the map is not known.
        """
        places: dict[int, list[str]] = defaultdict(list)
        for cell, place in () if self.visits is None else self.visits.tolist():
            places[cell].append(str(place))
        rows = [
            (*pose, " ".join(places.get(cell, ()))) for cell, pose in enumerate(self.poses.tolist())
        ]
        with io.StringIO(newline="") as text:
            csv.writer(text, lineterminator="\n").writerows([_COLUMNS, *rows])
            return text.getvalue()


def _pose(x: float, y: float, yaw: float) -> dict[str, Any]:
    """Return a geometry_msgs/Pose in the plane; its quaternion turns round the z axis."""
    return {
        "position": {"x": x, "y": y, "z": 0.0},
        "orientation": {
            "x": 0.0,
            "y": 0.0,
            "z": float(np.sin(yaw / 2)),
            "w": float(np.cos(yaw / 2)),
        },
    }
