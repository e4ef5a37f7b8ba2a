"""A front of tours as JSON: of stops or cities, or of the places of a map."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray
from paretour.choice import balances, losses
from pydantic_core import to_json

from service.coverage.frame import CoveragePath
from service.coverage.survey import Survey
from service.front import Front
from service.kinds.front_document import FrontDocument, encode_path, joined, with_member
from service.objectives import OBJECTIVES
from service.requests.stops import Labels


def encode_front(
    front: Front,
    actor: Mapping[str, str],
    surveyed: Survey | None = None,
    paths: Iterable[CoveragePath] | None = None,
    labels: Labels | None = None,
    arrivals: NDArray[np.float64] | None = None,
) -> FrontDocument:
    """Return a front as JSON.

    Args:
        front: The front.
        actor: The name and digest of the network, which is left out if it built no tours.
        surveyed: The map, whose places and uncovered cells are members of the document.
        paths: The path of each tour.
        labels: The names of stops and objectives.
        arrivals: All lengths of each tour up to each of its stops, shape (k, stops, m).
    """
    encoded: Iterable[bytes] = map(to_json, _rows(front, arrivals, labels))
    if paths is not None:
        with_paths = zip(encoded, paths, strict=True)
        encoded = (with_member(tour, b"path", encode_path(path)) for tour, path in with_paths)
    tours, ends = joined(encoded)
    return FrontDocument.of(
        front,
        kind="front" if surveyed is None else "coverage",
        cities=front.n,
        hypervolume_bound=front.bound,
        actor=actor if front.constructed else None,
        **on_map(surveyed),
        closed=None if front.closed else False,
        **({} if labels is None else labels.members),
        tours=tours,
        ends=ends,
        gained=front.gained,
    )


def on_map(surveyed: Survey | None) -> dict[str, Any]:
    """Return the members about a map: where its places lie, and which cells are uncovered.

    And about its objectives, if the caller named them.
    """
    if surveyed is None:
        return {}
    members = {"places": surveyed.places.tolist(), "uncovered": asdict(surveyed.uncovered)}
    if surveyed.objectives:
        members["objectives"] = [asdict(objective) for objective in surveyed.objectives]
    return members


def _rows(
    front: Front, arrivals: NDArray[np.float64] | None, labels: Labels | None
) -> Iterator[dict[str, Any]]:
    """Yield the members of each tour, ready for JSON."""
    flat = front.points.shape[1] == OBJECTIVES
    columns = {
        "angle": front.angles if flat else None,
        "balance": balances(front.points) if flat else None,
        "losses": None if flat else losses(front.points),
        "kept": front.kept,
        "departure": front.departures,
        "lengths": front.points,
        "means": front.means,
        "p90": front.p90,
        "tour": front.tours,
        "arrivals": arrivals,
        "times": front.times,
    }
    given = {name: values.tolist() for name, values in columns.items() if values is not None}
    rows = (dict(zip(given, row, strict=True)) for row in zip(*given.values(), strict=True))
    if labels is None:
        return rows
    ids = np.array([stop.id for stop in labels.stops], object)
    return (
        {**row, "stops": ids[tour].tolist()} for row, tour in zip(rows, front.tours, strict=True)
    )
