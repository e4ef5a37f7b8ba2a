"""The front of a map that is replanned: its map, places, ends and tours, read from the store."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.coverage.coverage import Coverage
from service.errors import Refusal
from service.instance import CLOSED, RouteEnds
from service.requests.coverage import CoverageRequest, parse_coverage_request
from service.requests.limits import Limits
from service.requests.replan.earlier_front import (
    EarlierFront,
    StoredFront,
    not_replannable,
    refused_now,
    with_tours,
)
from service.requests.replan.rest_request import RestOfMapRequest

MAP_MODELS: Mapping[str, type[CoverageRequest]] = {
    "coverage": CoverageRequest,
    "replan-coverage": RestOfMapRequest,
}


@dataclass(frozen=True, eq=False)
class EarlierMap:
    """A front of a map that is replanned.

    Args:
        coverage: The task that it is the front of.
        cells: Row and column of each place, shape (n, 2), also of those laid out by a spacing.
        front: Its tours through the places, which are named by their indexes.
    """

    coverage: Coverage
    cells: NDArray[np.int64]
    front: EarlierFront


def read_earlier_map(stored: StoredFront, limits: Limits) -> EarlierMap:
    """Return the front of a map that was stored.

    Raises:
        Refusal: It cannot be read under these limits.
    """
    source = stored.source
    try:
        model = MAP_MODELS[source.kind]
        coverage = parse_coverage_request(source.body, limits, source.upload, model).coverage()
    except Refusal as refusal:
        raise refused_now(stored.id, refusal) from None
    if coverage.robots:
        raise not_replannable(stored.id, "it is of plans for several robots")
    cells = np.array(stored.places or (), np.int64).reshape(-1, 2)

    def ends_of(tour: NDArray[np.int64]) -> tuple[RouteEnds, int]:
        return _ends(coverage, tour), int(tour[0])

    return EarlierMap(coverage, cells, with_tours(stored, len(cells), ends_of))


def _ends(coverage: Coverage, tour: NDArray[np.int64]) -> RouteEnds:
    """Return the ends that all tours share, given one of them, as places."""
    if coverage.ends.closed:
        return CLOSED
    starts = coverage.start_pose is not None or coverage.ends.start is not None
    ends = coverage.end_pose is not None or coverage.ends.end is not None
    return RouteEnds(False, int(tour[0]) if starts else None, int(tour[-1]) if ends else None)
