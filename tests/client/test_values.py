"""Answers become values."""

import pytest
from paretour import Actor, Objective
from paretour.expect import value_of
from paretour.values import parse_front, parse_tour

from tests.helpers.answers import EMPTY, FRONT, NAMED


def test_arrays_cannot_be_written_to() -> None:
    front = parse_front(FRONT)
    with pytest.raises(ValueError, match="read-only"):
        front.tours[0, 0] = 1


def test_an_empty_front_has_shapes_all_the_same() -> None:
    front = parse_front(EMPTY)
    assert (front.tours.shape, front.lengths.shape, front.angles.shape) == ((0, 3), (0, 2), (0,))
    with pytest.raises(ValueError, match="empty"):
        front.nearest(45)


def test_the_nearest_tour_is_that_of_the_nearest_angle() -> None:
    tour = parse_front(FRONT).nearest(40)
    assert (tour.front, tour.angle, tour.tour.tolist()) == ("f", 30.0, [0, 2, 1])


def test_a_network_is_shown_with_all_that_is_known_of_it() -> None:
    document = {
        **{"name": "pa-one", "digest": "d", "commit": "c", "inputs": "coordinates"},
        **{"sizes": [5, 100], "angles": [0, 90], "config": {}, "figures": {}},
    }
    shown = repr(value_of(Actor)(document, "answer"))
    assert shown.startswith("Actor(name='pa-one', digest='d'")
    assert "sizes=[5, 100]" in shown


def test_a_tour_over_a_map_has_its_path() -> None:
    path = {"cells": [[0, 0], [0, 1]], "metres": 2.0}
    tour = parse_tour(
        {
            "front": "f",
            "angle": 45.0,
            "balance": 0.5,
            "lengths": [1, 2],
            "tour": [0, 1],
            "path": path,
        }
    )
    assert tour.path is not None
    assert (tour.path.cells.tolist(), tour.path.metres) == ([[0, 0], [0, 1]], 2.0)


def test_arrivals_come_with_the_tours_that_have_them() -> None:
    arrivals = [[0.0, 0.0], [1.0, 2.0]]
    items = [{**item, "arrivals": arrivals} for item in FRONT["front"]]  # type: ignore[union-attr]
    tour = parse_front(FRONT | {"front": items}).choose(balance=0.0)
    assert tour.arrivals is not None
    assert tour.arrivals.tolist() == arrivals
    assert parse_front(FRONT).choose(balance=0.0).arrivals is None


def test_tours_have_ids_and_objectives_names_where_the_request_had_them() -> None:
    front = parse_front(NAMED)
    assert front.stops == (("depot", "b 2", "c"), ("depot", "c", "b 2"))
    assert front.objectives == (Objective("way", "m"), Objective("risk [red]$", None))
    assert front.nearest(40).stops == ("depot", "c", "b 2")
    assert parse_tour({"front": "f", **NAMED["front"][1]}).stops == ("depot", "c", "b 2")
    unnamed = parse_front(FRONT)
    assert (unnamed.stops, unnamed.objectives, unnamed.nearest(40).stops) == (None, None, None)
