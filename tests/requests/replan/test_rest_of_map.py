"""The rest of a way over a map: its task, and what is refused where."""

import json
from typing import Any

import numpy as np
import pytest

from service.coverage.coverage import Coverage
from service.coverage.frame import MapFrame
from service.errors import Refusal
from service.kinds.parsing import parse_replan
from service.kinds.tours import survey_map
from service.requests.limits import Limits
from service.requests.replan.way import ReplanSource
from service.requests.task import Task, TaskSource
from tests.helpers.actors import info_of
from tests.helpers.changes import Found, front_of

LIMITS = Limits(body_bytes=2**20, cities=20, cells=200, preferences=99, size=9999, seconds=9)
INFOS = {"matrices": info_of("matrices", "matrices")}
ROWS, COLUMNS = 5, 7
WALLS = [[1, 1], [1, 4], [3, 2]]
PLACES = [[0, 0], [0, 6], [2, 3], [4, 0], [4, 6], [2, 5]]
TOURS = [[0, 1, 5, 4, 2, 3], [0, 3, 4, 1, 5, 2]]
ORIGIN = [3.0, -2.0, 0.5]
FRAME = MapFrame(origin=ORIGIN, cell_size=0.5, rows=ROWS)
LAYER = np.random.default_rng(1).integers(1, 9, (ROWS, COLUMNS)).tolist()
MATRIX = (np.random.default_rng(2).integers(1, 9, (6, 6)) * (1 - np.eye(6))).tolist()
POINTS = np.random.default_rng(3).integers(0, 9, (6, 2)).tolist()
MEMBERS = {"cost_layer": "cost_layers"}  # of the task, where they have another name
SECONDS = {"cost_layer": LAYER, "second_matrix": MATRIX, "second_coordinates": POINTS}


def grid(walls: list[list[int]]) -> list[list[int]]:
    return [[int([r, c] in walls) for c in range(COLUMNS)] for r in range(ROWS)]


def pose_of(cell: list[int]) -> list[float]:
    pose: list[float] = FRAME.points(np.array([cell]))[0].tolist()
    return pose


def rest(second: str = "cost_layer", more: dict[str, Any] | None = None, **request: Any) -> Task:
    """The rest of a front of two tours, after a request to replan it."""
    members = {
        "grid": grid(WALLS),
        "cell_size": 0.5,
        "origin": ORIGIN,
        "places": PLACES,
        second: SECONDS[second],
        **(more or {}),
    }
    came = {name: value for name, value in members.items() if value is not None}
    found = Found(np.array(TOURS), np.array([[1.0, 2.0], [2.0, 1.0]]), PLACES)
    front = front_of(TaskSource("coverage", json.dumps(came).encode()), found)
    task = parse_replan(ReplanSource(json.dumps(request).encode(), front), LIMITS, INFOS)
    survey_map(task.subject, task, LIMITS, lambda: False)  # as a worker does before it plans
    return task


def map_of(task: Task) -> Coverage:
    assert isinstance(task.subject, Coverage)
    return task.subject


def walls_of(task: Task) -> list[list[int]]:
    return np.argwhere(map_of(task).blocked).tolist()


def test_the_map_is_that_of_the_front_with_what_has_changed() -> None:
    assert walls_of(rest()) == WALLS
    assert walls_of(rest(blocked=[[2, 1]], freed=[[1, 4]])) == [[1, 1], [2, 1], [3, 2]]
    # Single cells are changed on the whole map that comes with them.
    assert walls_of(rest(grid=grid([]), blocked=[[3, 3]])) == [[3, 3]]
    # A cell in both lists is free.
    assert walls_of(rest(blocked=[[2, 1]], freed=[[2, 1]])) == WALLS


@pytest.mark.parametrize("second", SECONDS)
def test_the_rest_has_the_places_that_are_left_and_the_costs_between_them(second: str) -> None:
    task = rest(second, done=[0, 1], tour=TOURS[0], remove=[4])
    coverage = map_of(task)
    left = [0, 1, 2, 3, 5]
    assert coverage.places is not None
    assert coverage.places.tolist() == [PLACES[place] for place in left]
    assert coverage.ends == (False, 1, 0)
    assert (coverage.start, task.options.start) == (1, 1)
    assert task.earlier is not None
    assert [left[place] for place in task.earlier.driven] == [1, 5, 2, 3, 0]
    expected = {
        "cost_layer": [LAYER],
        "second_matrix": [[MATRIX[i][j] for j in left] for i in left],
        "second_coordinates": [POINTS[i] for i in left],
    }
    for name in SECONDS:
        costs = getattr(coverage, MEMBERS.get(name, name))
        assert (None if costs is None else costs.tolist()) == (
            expected[name] if name == second else None
        )


@pytest.mark.parametrize("second", SECONDS)
def test_a_new_layer_replaces_any_second_objective(second: str) -> None:
    layer = [[2] * COLUMNS] * ROWS
    coverage = map_of(rest(second, cost_layer=layer, add=[[2, 1]]))
    assert coverage.cost_layers is not None
    assert coverage.cost_layers.tolist() == [layer]
    assert (coverage.second_matrix, coverage.second_coordinates) == (None, None)
    assert coverage.places is not None
    assert coverage.places.tolist() == [*PLACES, [2, 1]]


@pytest.mark.parametrize("where", [{"pose": pose_of([2, 1])}, {"position": [2, 1]}])
def test_the_way_goes_on_at_a_pose_or_a_cell_and_a_place_is_none_twice(
    where: dict[str, Any],
) -> None:
    coverage = map_of(rest(**where, done=[0], add=[[3, 3]]))
    assert coverage.places is not None
    assert coverage.places[[coverage.start, -2]].tolist() == [[2, 1], [3, 3]]
    assert coverage.ends == (False, 7, 0)
    there = map_of(rest("second_matrix", pose=pose_of(PLACES[2]), done=[0]))
    assert there.places is not None
    assert there.places.tolist() == PLACES
    assert there.ends == (False, 2, 0)


def test_what_may_have_changed_everywhere_has_touched_every_place() -> None:
    for request in ({"blocked": [[2, 1]]}, {"freed": WALLS}, {"grid": grid([])}):
        earlier = rest(**request).earlier
        assert earlier is not None
        assert earlier.touched is None
    earlier = rest(remove=[5]).earlier
    assert earlier is not None
    assert earlier.touched is not None


@pytest.mark.parametrize(
    ("second", "request_", "pointer", "detail"),
    [
        ("cost_layer", {"blocked": [[9, 0]]}, "/blocked/0", "must be a cell of the grid"),
        ("cost_layer", {"blocked": [[0, 0], [0, 7]]}, "/blocked/1", "must be a cell of the grid"),
        ("cost_layer", {"freed": [[5, 0]]}, "/freed/0", "must be a cell of the grid"),
        ("cost_layer", {"blocked": [[0, -1]]}, "/blocked/0/1", "at least 0"),
        ("cost_layer", {"blocked": [[0]]}, "/blocked/0", "must have 2 items"),
        ("cost_layer", {"grid": [[0]]}, "/grid", "as large as that of the front"),
        ("cost_layer", {"grid": [[2] * COLUMNS] * ROWS}, "/grid/0/0", "must be 0 or 1"),
        ("cost_layer", {"cost_layer": [[1]]}, "/cost_layer", "must be as large"),
        ("cost_layer", {"add": [[9, 9]]}, "/add/0", "must be a cell of the grid"),
        ("cost_layer", {"add": [{"id": "a"}]}, "/add/0", "must be row and column"),
        ("cost_layer", {"add": [[1, 1]]}, "/add/0", "is an obstacle"),
        ("cost_layer", {"add": [[2, 1], [2, 2]], "blocked": [[2, 2]]}, "/add/1", "is an obstacle"),
        ("cost_layer", {"position": [1, 1]}, "/position", "is an obstacle"),
        ("cost_layer", {"position": {"id": "a"}}, "/position", "row and column"),
        ("cost_layer", {"pose": [1e9, 0]}, "/pose", "must be in a cell of the grid"),
        ("cost_layer", {"pose": [0, 0], "position": 1}, "/pose", "or position"),
        ("cost_layer", {"pose": pose_of([1, 1])}, "/pose", "obstacle"),
        ("cost_layer", {"costs": []}, "/costs", "must be left out"),
        ("cost_layer", {"objectives": []}, "/objectives", ""),
        ("cost_layer", {"geometry": "straight"}, "/geometry", "must be left out"),
        ("cost_layer", {"done": ["a"]}, "/done/0", "must be"),
        ("cost_layer", {"done": [6]}, "/done/0", "must be a stop of the front, 0 to 5, got 6"),
        ("cost_layer", {"remove": [0]}, "/remove/0", "must not be where the way goes on"),
        (
            "cost_layer",
            {"remove": [1], "done": [1]},
            "/remove/0",
            "must be a stop that is not done",
        ),
        ("cost_layer", {"add": [[2, 1]] * 15}, "/add", "at most 20"),
        ("second_matrix", {"add": [[2, 1]]}, "/add/0", "only a cost layer"),
        ("second_coordinates", {"position": [2, 1]}, "/position", "only a cost layer"),
        ("second_matrix", {"pose": pose_of([2, 1])}, "/pose", "only a cost layer"),
    ],
)
def test_what_cannot_be_on_a_map_is_refused_at_its_place(
    second: str, request_: dict[str, Any], pointer: str, detail: str
) -> None:
    with pytest.raises(Refusal) as refused:
        rest(second, **request_)
    assert refused.value.errors[0].pointer == pointer, refused.value.detail
    assert detail in refused.value.detail


def test_a_pose_needs_a_map_with_an_origin() -> None:
    with pytest.raises(Refusal, match="must be in the frame of a map with an origin") as refused:
        rest(more={"origin": None}, pose=[0.0, 0.0])
    assert refused.value.errors[0].pointer == "/pose"


def test_a_place_that_became_an_obstacle_is_to_be_removed() -> None:
    with pytest.raises(Refusal, match="must have place 2") as refused:
        rest(blocked=[PLACES[2]])
    assert refused.value.errors[0].pointer == "/remove"
    places = map_of(rest(blocked=[PLACES[2]], remove=[2])).places
    assert places is not None
    assert places.tolist() == [place for place in PLACES if place != PLACES[2]]


def test_a_place_that_no_path_leads_to_any_more_is_to_be_removed() -> None:
    walls = [[3, 0], [3, 1], [4, 1]]
    with pytest.raises(Refusal, match="place 3, as it must be reachable from where the way goes"):
        rest(grid=grid(walls))
    assert walls_of(rest(grid=grid(walls), remove=[3])) == walls
