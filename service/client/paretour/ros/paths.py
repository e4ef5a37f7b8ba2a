"""Write paths over a map for robots: as poses, as messages nav_msgs/Path, and as CSV."""

import csv
import io
from collections import defaultdict
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from paretour.expect import floats, indexes

Array = NDArray[np.float64]
PAIR = 2  # numbers: of a cell, a point or a length under two objectives
_PAIRS = {"read": lambda _: indexes(None, PAIR)}
_COLUMNS = ("x", "y", "yaw", "place")


@dataclass(frozen=True, eq=False)
class Path:
    """The way of a tour over a map, and its length.

    Attributes:
        cells: Rows and columns, shape (m, 2), from the first place back to it; for an open route,
            to the last place.
        metres: The length.
        points: x and y of the middle of each cell in the frame of the map, in metres, shape (m, 2);
            None if the origin of the map is not known.
        yaws: The direction in radians in which the robot leaves each cell, and at the last cell the
            one in which it arrives, shape (m,). None without points.
        visits: The index in `cells` and the place, shape (k, 2), for each place of the tour in
            order, back to the first if it is closed. All other cells are on the way.
    """

    cells: NDArray[np.int64] = field(metadata=_PAIRS)
    metres: float
    points: Array | None = field(
        default=None, metadata={"read": lambda path: floats(len(path["cells"]), PAIR)}
    )
    yaws: Array | None = field(
        default=None, metadata={"read": lambda path: floats(len(path["cells"]))}
    )
    visits: NDArray[np.int64] | None = field(default=None, metadata=_PAIRS)

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
