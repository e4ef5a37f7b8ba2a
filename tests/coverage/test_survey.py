"""Coverage planning without HTTP: grids and places in, instances and paths out."""

import pickle
from typing import Any

import numpy as np
import pytest

from service.coverage.survey import Coverage, survey
from service.errors import Cancelled, InvalidCoverage, Refusal, TooManyPlaces
from service.instance import RouteEnds, tour_lengths

ROOT2 = np.sqrt(2)
# A room with a wall that leaves a way round on the right: 1 is an obstacle.
ROOM = np.array(
    [
        [0, 0, 0, 0, 0, 0],
        [0, 0, 0, 0, 0, 0],
        [1, 1, 1, 1, 0, 0],
        [0, 0, 0, 0, 0, 0],
        [0, 0, 0, 0, 0, 0],
    ],
    dtype=np.bool_,
)
PLACES = np.array([[0, 0], [4, 0], [4, 5]])
SECOND = np.array([[0.0, 5.0, 1.0], [2.0, 0.0, 4.0], [3.0, 6.0, 0.0]])


def never() -> bool:
    return False


def room(**changed: Any) -> Coverage:
    given = {"blocked": ROOM, "cell_size": 0.5, "places": PLACES, "second_matrix": SECOND}
    return Coverage(**{**given, **changed})


def test_the_first_objective_is_how_far_the_robot_goes_in_metres() -> None:
    found = survey(room(), 10, never)
    assert found.instance.matrices is not None
    lengths, second = found.instance.matrices
    # By hand. Round the wall: to (1, 4) and on to (3, 4), a corner is cut nowhere.
    assert lengths[0, 1] == pytest.approx(0.5 * (2 * (3 + ROOT2) + 2))
    assert lengths[0, 2] == pytest.approx(0.5 * (5 + 2 * ROOT2))
    assert lengths[1, 2] == pytest.approx(0.5 * 5)
    np.testing.assert_array_equal(second, SECOND)


def test_a_cost_layer_is_integrated_along_the_cheapest_of_the_shortest_paths() -> None:
    layer = np.zeros((3, 3))
    layer[0, 1] = 7.0
    open_ground = np.zeros((3, 3), np.bool_)
    places = np.array([[0, 0], [0, 2], [1, 2]])
    found = survey(
        Coverage(blocked=open_ground, cell_size=2.0, places=places, cost_layers=layer[np.newaxis]),
        10,
        never,
    )
    assert found.instance.matrices is not None
    lengths, costs = found.instance.matrices
    # Straight through the costly cell, as no other path is as short: twice 2 m at a mean of 3.5.
    assert (lengths[0, 1], costs[0, 1]) == (4, 14)
    # A diagonal step first keeps clear of it, and is as short as a diagonal step at the end.
    assert lengths[0, 2] == pytest.approx(2 * (1 + ROOT2))
    assert costs[0, 2] == 0
    np.testing.assert_array_equal(costs, costs.T)


def test_coordinates_give_distances_as_second_objective() -> None:
    points = np.array([[0.0, 0.0], [3.0, 4.0], [0.0, 1.0]])
    found = survey(room(second_matrix=None, second_coordinates=points), 10, never)
    assert found.instance.matrices is not None
    np.testing.assert_allclose(
        found.instance.matrices[1], [[0, 5, 1], [5, 0, 18**0.5], [1, 18**0.5, 0]]
    )


def test_obstacles_grow_by_the_radius() -> None:
    wide = survey(room(robot_radius=0.5), 10, never)
    narrow = survey(room(), 10, never)
    assert wide.instance.matrices is not None
    assert narrow.instance.matrices is not None
    # The robot keeps a cell off the wall: round it at column 5, not 4.
    assert wide.instance.matrices[0, 0, 1] == pytest.approx(0.5 * (10 + 2 * ROOT2))
    assert narrow.instance.matrices[0, 0, 1] < wide.instance.matrices[0, 0, 1]


def test_paths_go_from_place_to_place_and_are_as_long_as_they_say() -> None:
    found = survey(room(), 10, never)
    tours = np.array([[0, 1, 2], [2, 1, 0]])
    forth, back = found.paths(tours)
    metres = tour_lengths(found.instance, tours)[:, 0]
    np.testing.assert_allclose([forth.metres, back.metres], metres)
    np.testing.assert_array_equal(forth.cells[::-1][0], PLACES[0])
    for path, tour in zip((forth, back), tours, strict=True):
        np.testing.assert_array_equal(path.cells[[0, -1]], PLACES[tour[[0, 0]]])
        assert not ROOM[tuple(path.cells.T)].any()
        steps = np.abs(np.diff(path.cells, axis=0))
        assert steps.max() == 1
        assert 0.5 * np.hypot(*steps.T).sum() == pytest.approx(path.metres)
        visited = [path.cells.tolist().index(place) for place in PLACES[tour].tolist()]
        assert visited == sorted(visited)


def test_the_path_of_an_open_route_leads_from_its_start_to_its_end() -> None:
    found = survey(room(ends=RouteEnds(closed=False, start=1, end=0)), 10, never)
    assert found.instance.fixed_ends == (1, 0)
    tour = np.array([[1, 2, 0]])
    [path] = found.paths(tour)
    np.testing.assert_array_equal(path.cells[[0, -1]], PLACES[[1, 0]])
    assert path.metres == pytest.approx(tour_lengths(found.instance, tour)[0, 0])
    assert 0.5 * np.hypot(*np.diff(path.cells, axis=0).T).sum() == pytest.approx(path.metres)
    assert len(list(found.paths(tour, len(path.cells)))) == 1
    with pytest.raises(Refusal, match="cells"):
        list(found.paths(tour, len(path.cells) - 1))


def test_an_open_route_through_one_place_is_a_path_of_one_cell() -> None:
    only = {"places": PLACES[:1], "second_matrix": np.zeros((1, 1))}
    found = survey(room(**only, ends=RouteEnds(closed=False, start=0)), 10, never)
    [path] = found.paths(np.array([[0]]))
    assert (path.cells.tolist(), path.metres) == (PLACES[:1].tolist(), 0.0)


@pytest.mark.parametrize(
    ("end", "sentence"), [(3, "end must be a place, 0 to 2, got 3"), (1, "must not be the start")]
)
def test_an_end_that_no_route_can_have_is_refused(end: int, sentence: str) -> None:
    with pytest.raises(InvalidCoverage, match=sentence):
        survey(room(ends=RouteEnds(closed=False, start=1, end=end)), 10, never)


def test_paths_of_too_many_cells_are_refused_before_any_is_traced(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = survey(room(), 10, never)
    tours = np.array([[0, 1, 2], [2, 1, 0]])
    cells = sum(len(path.cells) for path in found.paths(tours))
    assert len(list(found.paths(tours, cells))) == 2
    monkeypatch.setattr("service.coverage.leg_paths.ShortestPaths", None)
    with pytest.raises(Refusal, match="ask for a size of 1") as raised:
        list(found.paths(tours, cells - 1))
    assert (raised.value.limit, raised.value.actual) == (cells - 1, cells)
    with pytest.raises(Refusal, match="ask without paths"):
        list(found.paths(tours, 3))


def test_tracing_ends_when_told_to() -> None:
    found = survey(room(), 10, never)
    with pytest.raises(Cancelled):
        list(found.paths(np.array([[0, 1, 2]]), stop=lambda: True))


def test_the_path_of_a_tour_of_one_place_is_that_place() -> None:
    only = {"places": PLACES[:1], "second_matrix": np.zeros((1, 1))}
    [path] = survey(room(**only), 10, never).paths(np.array([[0]]))
    assert (path.cells.tolist(), path.metres) == ([[0, 0]], 0)


def test_places_are_laid_out_where_a_spacing_is_given() -> None:
    layer = {"second_matrix": None, "cost_layers": np.ones((1, *ROOM.shape))}
    found = survey(room(places=None, spacing=1.5, **layer), 10, never)
    assert found.places.tolist() == [[1, 1], [1, 4], [4, 1], [4, 4]]
    with pytest.raises(TooManyPlaces, match="at most 3 places, got 4") as raised:
        survey(room(places=None, spacing=1.5, **layer), 3, never)
    again = pickle.loads(pickle.dumps(raised.value))
    assert (again.limit, again.actual, str(again)) == (3, 4, str(raised.value))


WALLED = np.array([[0, 0, 1, 0], [0, 0, 1, 0]], dtype=np.bool_)


@pytest.mark.parametrize(
    ("changed", "faults"),
    [
        ({"cell_size": 0.0}, [("cell_size", "must be positive, got 0")]),
        ({"robot_radius": -1.0}, [("robot_radius", "must not be negative, got -1")]),
        ({"places": None}, [("places", "or spacing is required, and not both")]),
        ({"spacing": 1.0}, [("places", "or spacing is required, and not both")]),
        ({"places": None, "spacing": 0.0}, [("spacing", "must be positive, got 0")]),
        (
            {"second_matrix": None},
            [("second_matrix", "or cost_layer or second_coordinates is required, and only one")],
        ),
        (
            {"second_coordinates": np.zeros((3, 2))},
            [("second_matrix", "or cost_layer or second_coordinates is required, and only one")],
        ),
        (
            {"second_matrix": None, "cost_layers": np.zeros((1, 5, 5))},
            [("cost_layer", "must be as large as grid, 5 x 6 cells, got 5 x 5 cells")],
        ),
        (
            {"second_matrix": None, "cost_layers": -np.eye(5, 6)[np.newaxis]},
            [("cost_layer/0/0", "must be finite and not negative, got -1")],
        ),
        (
            {"second_matrix": SECOND[:2, :2]},
            [("second_matrix", "must have a row for each of 3 places, got 2")],
        ),
        ({"start": 3}, [("start", "must be a place, 0 to 2, got 3")]),
        ({"robot_radius": 9.0}, [("grid", "farther than 9 m from every obstacle, and there is")]),
        (
            {"places": np.array([[2, 0], [0, 0], [5, 0]])},
            [
                ("places/0", "must be a free cell, and [2, 0] is an obstacle"),
                ("places/2", "must be a cell of the grid of 5 x 6 cells, got [5, 0]"),
            ],
        ),
        (
            {"places": np.array([[0, 0], [1, 1], [4, 5]]), "robot_radius": 0.5},
            [("places/1", "must be a cell farther than 0.5 m from every obstacle, and [1, 1]")],
        ),
        (
            {"blocked": WALLED, "places": np.array([[0, 0], [0, 3], [1, 3]])},
            [
                ("places/1", "must be reachable from places/0, and no path leads there"),
                ("places/2", "must be reachable from places/0, and no path leads there"),
            ],
        ),
        (
            {"blocked": WALLED, "places": np.array([[0, 0], [0, 3], [1, 3]]), "start": 2},
            [("places/0", "must be reachable from places/2, and no path leads there")],
        ),
    ],
)
def test_what_cannot_be_covered_is_named(
    changed: dict[str, Any], faults: list[tuple[str, str]]
) -> None:
    with pytest.raises(InvalidCoverage) as raised:
        survey(room(**changed), 10, never)
    assert [found.part for found in raised.value.faults] == [part for part, _ in faults]
    for found, (_, sentence) in zip(raised.value.faults, faults, strict=True):
        assert sentence in found.demand


def test_a_survey_that_is_told_to_stop_ends() -> None:
    with pytest.raises(Cancelled):
        survey(room(), 10, lambda: True)
