"""A front of tours as JSON: of stops or cities, or of the places of a map."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from service.coverage.frame import CoveragePath
from service.coverage.survey import Survey
from service.front import Front
from service.kinds.front_document import FrontDocument, Timings
from service.kinds.json_parts import encode_path, encode_tours, joined, split, with_member
from service.pareto import balances
from service.requests.stops import Labels


def encode_front(
    front: Front,
    actor: Mapping[str, str],
    surveyed: Survey | None = None,
    paths: Iterable[CoveragePath] | None = None,
    labels: Labels | None = None,
    arrivals: NDArray[np.float64] | None = None,
) -> FrontDocument:
    """Return a front as JSON, with the ids of stops, the arrivals and the paths that are given.

    With a survey it has the places on the map, and the cells that are uncovered.

    The actor is left out if it built no tours. Arrivals have shape (m, stops, 2).
    """
    tours, ends = encode_tours(_rows(front, arrivals))
    if labels is not None:
        tours, ends = joined(_with_stops(split(tours, ends), front.tours, labels))
    if paths is not None:
        tours, ends = joined(
            with_member(tour, b"path", encode_path(path))
            for tour, path in zip(split(tours, ends), paths, strict=True)
        )
    return FrontDocument(
        kind="front" if surveyed is None else "coverage",
        cities=front.n,
        points=front.found,
        hypervolume=front.hypervolume,
        hypervolume_bound=front.bound,
        reference_point=front.reference_point.tolist(),
        scale=front.scale.tolist(),
        timings_ms=Timings(front.timings),
        terminated=front.terminated,
        actor=actor if front.constructed else None,
        **on_map(surveyed),
        closed=None if front.closed else False,
        **({} if labels is None else labels.members),
        tours=tours,
        ends=ends,
        angles=front.angles.tobytes(),
        gained=front.gained,
    )


def on_map(surveyed: Survey | None) -> dict[str, Any]:
    """Return the members about a map: where its places lie, and which cells are uncovered."""
    if surveyed is None:
        return {}
    return {"places": surveyed.places.tolist(), "uncovered": asdict(surveyed.uncovered)}


def _rows(front: Front, arrivals: NDArray[np.float64] | None) -> list[dict[str, Any]]:
    """Return the members of each tour, all of them numbers, ready for JSON."""
    columns = zip(
        front.angles.tolist(),
        balances(front.points).tolist(),
        _optional("kept", front.kept, front),
        front.points.tolist(),
        front.tours.tolist(),
        _optional("arrivals", arrivals, front),
        strict=True,
    )
    return [
        {"angle": angle, "balance": balance, **kept, "lengths": lengths, "tour": tour, **arrived}
        for angle, balance, kept, lengths, tour, arrived in columns
    ]


def _optional(name: str, values: NDArray[np.float64] | None, front: Front) -> list[dict[str, Any]]:
    """Return a member for each tour of a front; without values, no members."""
    if values is None:
        return [{}] * len(front.tours)
    return [{name: value} for value in values.tolist()]


def _with_stops(encoded: list[bytes], tours: NDArray[np.integer], labels: Labels) -> list[bytes]:
    """Return the JSON of each tour with the ids of its stops; each id is encoded only once."""
    ids = np.array([to_json(stop.id) for stop in labels.stops], object)
    return [
        with_member(tour, b"stops", b"[%b]" % b",".join(stops))
        for tour, stops in zip(encoded, ids[tours].tolist(), strict=True)
    ]
