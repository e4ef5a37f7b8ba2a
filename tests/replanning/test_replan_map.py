"""Replanned fronts of maps against new fronts of what is left on the map as it is then."""

import json
import tracemalloc
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest

from service.coverage.frame import MapFrame
from service.jobs.task_runner import TaskRunner
from service.kinds.front_document import FrontDocument, joined
from service.kinds.parsing import parse_replan, parse_task
from service.requests.limits import Limits
from service.requests.replan.way import ReplanSource, StoredFront
from service.requests.task import Task, TaskSource
from service.requests.task_codec import encode_task
from tests.helpers.actors import Shuffler, info_of
from tests.helpers.changes import front_of

LIMITS = Limits(body_bytes=2**20, cities=20, cells=200, preferences=99, size=9999, seconds=9)
RUNNER = TaskRunner({"any": Shuffler(info=info_of("any", "matrices"))}, LIMITS)
ROWS, COLUMNS = 5, 7
WALLS = [[1, 1], [1, 4], [3, 2]]
SECONDS = ("cost_layer", "second_matrix", "second_coordinates")
ORIGIN = [3.0, -2.0, 0.5]
FRAME = MapFrame(origin=ORIGIN, cell_size=0.5, rows=ROWS)


def rest_of(front: StoredFront, body: bytes) -> Task:
    return parse_replan(ReplanSource(body, front), LIMITS, RUNNER.infos)


@dataclass
class Scene:
    """A map, the request of a front of it, and a generator for what changes."""

    seed: int
    second: str = "cost_layer"
    more: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.rng = np.random.default_rng(self.seed)
        cells = [[row, column] for row in range(ROWS) for column in range(COLUMNS)]
        self.rng.shuffle(cells)
        self.free = [cell for cell in cells if cell not in WALLS]
        self.places = self.free[:6]
        second: dict[str, Any] = {
            "cost_layer": self.rng.integers(1, 9, (ROWS, COLUMNS)).tolist(),
            "second_matrix": self.rng.integers(0, 9, (6, 6)).tolist(),
            "second_coordinates": self.rng.integers(0, 9, (6, 2)).tolist(),
        }
        members = {
            "grid": grid(WALLS),
            "cell_size": 0.5,
            "origin": ORIGIN,
            "places": self.places,
            "size": 9999,
            self.second: second[self.second],
            **self.more,
        }
        self.request = {k: v for k, v in members.items() if k != "places" or v is not None}
        self.source = TaskSource("coverage", json.dumps(self.request).encode())
        self.front = planned(self.source)
        self.tours = [item["tour"] for item in json.loads(b"[" + self.front.tours + b"]")]

    def rest(self, **request: Any) -> Task:
        stored = front_of(self.source, self.front)
        body = json.dumps({"size": 9999, **request}).encode()
        return rest_of(stored, body)

    def subset(self, indexes: list[int]) -> dict[str, Any]:
        """The second objective between places of the front, as a new request has it."""
        values = self.request[self.second]
        if self.second == "second_matrix":
            return {self.second: [[values[i][j] for j in indexes] for i in indexes]}
        if self.second == "second_coordinates":
            return {self.second: [values[i] for i in indexes]}
        return {self.second: values}


def grid(walls: list[list[int]]) -> list[list[int]]:
    return [[int([r, c] in walls) for c in range(COLUMNS)] for r in range(ROWS)]


def planned(task: Task | TaskSource) -> FrontDocument:
    if isinstance(task, TaskSource):
        task = parse_task(task, LIMITS, RUNNER.infos)
    return RUNNER.run(task, lambda: False, lambda *_: None)


def new_front(scene: Scene, **request: Any) -> FrontDocument:
    body = json.dumps({**scene.request, **request}).encode()
    return planned(TaskSource("coverage", body))


def same_lengths(front: FrontDocument, other: FrontDocument) -> bool:
    points, others = front.lengths, other.lengths
    return points.shape == others.shape and np.allclose(points, others)


@pytest.mark.parametrize("second", SECONDS)
@pytest.mark.parametrize("seed", range(4))
def test_the_rest_is_planned_on_the_map_as_it_is_now(second: str, seed: int) -> None:
    scene = Scene(seed, second)
    driven = scene.tours[int(scene.rng.integers(len(scene.tours)))]
    removed = driven[-1:]
    left = driven[2:-1]
    wall = next(cell for cell in scene.free if cell not in scene.places)
    rest = planned(scene.rest(done=driven[:3], tour=driven, remove=removed, blocked=[wall]))
    indexes = [driven[2], *left[1:], driven[0]]
    expected = new_front(
        scene,
        grid=grid([*WALLS, wall]),
        places=[scene.places[i] for i in indexes],
        closed=False,
        start=0,
        end=len(indexes) - 1,
        **scene.subset(indexes),
    )
    assert same_lengths(rest, expected)
    assert rest.places is not None
    for item in json.loads(b"[" + rest.tours + b"]"):
        ends = [rest.places[item["tour"][place]] for place in (0, -1)]
        assert ends == [scene.places[driven[2]], scene.places[driven[0]]]
        assert 0 <= item["kept"] <= 1


@pytest.mark.parametrize("closed", [True, False])
def test_the_robot_goes_on_at_its_pose_through_places_that_are_added(closed: bool) -> None:
    scene = Scene(5, more={} if closed else {"closed": False, "start": None})
    here, new = [cell for cell in scene.free if cell not in scene.places][:2]
    pose = FRAME.points(np.array([here]))[0].tolist()
    rest = planned(scene.rest(pose=pose, add=[new], freed=WALLS, remove=[3]))
    cells = [here, new, *(scene.places[i] for i in (1, 2, 4, 5)), scene.places[0]]
    end = 6 if closed else None  # place 0, from which closed tours lead, and to which they return
    expected = new_front(scene, grid=grid([]), places=cells, closed=False, start=0, end=end)
    assert same_lengths(rest, expected)


def test_a_whole_map_and_a_whole_layer_may_be_new() -> None:
    scene = Scene(6)
    layer = scene.rng.integers(1, 9, (ROWS, COLUMNS)).tolist()
    rest = planned(scene.rest(grid=grid([]), cost_layer=layer))
    assert same_lengths(rest, new_front(scene, grid=grid([]), cost_layer=layer))
    again = StoredFront("rest", encode_task(scene.rest(grid=grid([]))), rest)
    body = json.dumps({"remove": [2], "size": 9999}).encode()
    second = planned(rest_of(again, body))
    places = [cell for i, cell in enumerate(scene.places) if i != 2]
    assert same_lengths(second, new_front(scene, grid=grid([]), places=places))


def test_places_of_poses_and_of_a_spacing_are_those_of_the_front() -> None:
    here = [0, 0]
    pose = FRAME.points(np.array([here]))[0].tolist()
    more = {"places": None, "spacing": 1.2, "start_pose": pose}
    scene = Scene(7, more=more)
    assert scene.front.places is not None
    n = len(scene.front.places)
    rest = planned(scene.rest(remove=[0] if scene.front.places[0] != here else [1]))
    assert rest.places is not None
    assert len(rest.places) == n - 1
    starts = {item["tour"][0] for item in json.loads(b"[" + rest.tours + b"]")}
    assert [rest.places[start] for start in starts] == [here]


def test_the_paths_of_a_front_are_not_parsed() -> None:
    scene = Scene(7)
    cells = ",".join(["[0,1]"] * 100_000)
    path = f',"arrivals":[{cells}],"path":{{"cells":[{cells}],"metres":1.0}}}}'.encode()
    tours, ends = joined(tour[:-1] + path for tour in scene.front.split())
    front = replace(scene.front, tours=tours, ends=ends)
    expected = scene.rest(done=[1])
    tracemalloc.start()
    try:
        rest = rest_of(front_of(scene.source, front), b'{"size": 9999, "done": [1]}')
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert encode_task(rest) == encode_task(expected)
    assert peak < 2**20
