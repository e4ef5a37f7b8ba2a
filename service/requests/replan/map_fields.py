"""The fields of requests to replan a front of a map: what has changed on the map."""

from typing import Annotated, Any

from pydantic import Field

from service.requests.coverage import Cell
from service.requests.maps.fields import Layer, empty_array
from service.requests.maps.robots import RobotPose
from service.requests.schemas import PlanFields
from service.requests.validation import invalid

_Cells = Annotated[list[Cell], Field(fail_fast=True)]


class MapChanges(PlanFields):
    """What has changed on the map of a front of `POST /coverage`."""

    pose: RobotPose = Field(
        default_factory=list,
        description="instead of position, on a map with an origin: x and y, and maybe yaw, of the"
        " robot in the frame of the map",
    )
    grid: Layer = Field(
        default_factory=empty_array,
        description="of a front of a map: the map anew, as large as it was, 0 where it is free and"
        " 1 an obstacle",
    )
    blocked: _Cells = Field(
        default_factory=list,
        description="of a front of a map: row and column of each cell that is an obstacle now",
    )
    freed: _Cells = Field(
        default_factory=list, description="likewise, of each cell that is an obstacle no more"
    )
    cost_layer: Layer = Field(
        default_factory=empty_array,
        description="of a front of a map: the second objective anew, as in `POST /coverage`",
    )
    paths: bool = Field(
        default=False, description="of a front of a map: whether each tour comes with its path"
    )

    @property
    def map_changed(self) -> bool:
        """Whether a path between two places may have changed."""
        return bool(self.grid.size or self.blocked or self.freed or self.cost_layer.size)


OF_MAPS = tuple(name for name in MapChanges.model_fields if name not in PlanFields.model_fields)
_OF_STOPS = ("costs", "objectives", "geometry")


def describe_map_changes(fields: dict[str, Any], most_cells: int) -> None:
    """Refine the fields of a map in the JSON schema of a request."""
    fields["grid"]["items"]["items"] = {"enum": [0, 1]}
    for name in ("blocked", "freed"):
        fields[name]["maxItems"] = most_cells


def check_of_stops(request: MapChanges) -> None:
    """Raise a refusal where a request about a front of stops has fields of maps."""
    _refuse(request, OF_MAPS, "a map, by POST /coverage")


def check_of_map(request: MapChanges) -> None:
    """Raise a refusal where a request about a front of a map has fields of stops."""
    _refuse(request, _OF_STOPS, "stops or cities, by POST /front")


def _refuse(request: MapChanges, names: tuple[str, ...], kind: str) -> None:
    for name in names:
        if name in request.model_fields_set:
            raise invalid(name, f"must be left out: it is for fronts of {kind}")
