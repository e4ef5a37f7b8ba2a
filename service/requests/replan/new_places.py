"""The places of a front of a map, with the new ones of a request to replan it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.coverage.coverage import Coverage
from service.requests.replan.earlier_map import EarlierMap
from service.requests.replan.fields import ReplanRequest
from service.requests.validation import invalid

Cells = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class AllPlaces:
    """The places of a front, the added ones, and the present position if it is new, in this order.

    Args:
        cells: Row and column of each.
        request: The request, in which the position is a place of the front, or the last of all.
    """

    cells: Cells
    request: ReplanRequest


def all_places(earlier: EarlierMap, coverage: Coverage, request: ReplanRequest) -> AllPlaces:
    """Return the places of the front and the new ones.

    Raises:
        Refusal: A new one is not a cell of the grid, or has no costs.
    """
    new = []
    for index, item in enumerate(request.add):
        if not isinstance(item, list):
            raise invalid(f"add/{index}", "must be row and column of a place on the map")
        _check_costs(coverage, f"add/{index}")
        new.append(item)
    name, cell = _position_cell(coverage, request)
    if cell is None:
        return AllPlaces(np.concatenate((earlier.cells, _cells(new))), request)
    there = np.flatnonzero((earlier.cells == cell).all(axis=1))
    if coverage.cost_layer is None and len(there):
        request = request.model_copy(update={"position": int(there[0])})
        return AllPlaces(np.concatenate((earlier.cells, _cells(new))), request)
    _check_costs(coverage, name)
    request = request.model_copy(update={"position": cell})
    return AllPlaces(np.concatenate((earlier.cells, _cells([*new, cell]))), request)


def _cells(cells: list[list[int]]) -> Cells:
    return np.array(cells, np.int64).reshape(-1, 2)


def _position_cell(coverage: Coverage, request: ReplanRequest) -> tuple[str, list[int] | None]:
    """Return the field of the position, and its cell; None if the position is a place.

    Raises:
        Refusal: It is given twice, is not a cell of the grid, or is in an unknown frame.
    """
    if not request.pose:
        if isinstance(request.position, list):
            return "position", request.position
        if request.position is None or isinstance(request.position, int | str):
            return "position", None
        raise invalid("position", "must be a place of the front, or row and column of one")
    if request.position is not None:
        raise invalid("pose", "or position must be left out")
    if coverage.frame is None:
        raise invalid("pose", "must be in the frame of a map with an origin")
    row, column = coverage.frame.cell(*request.pose[:2])
    rows, columns = coverage.blocked.shape
    if not (0 <= row < rows and 0 <= column < columns):
        raise invalid("pose", f"must be in a cell of the grid of {coverage.size}")
    return "pose", [row, column]


def _check_costs(coverage: Coverage, part: str) -> None:
    if coverage.cost_layer is None:
        demand = "must be in the cell of a place, as only a cost_layer has costs of other cells"
        raise invalid(part, demand)
