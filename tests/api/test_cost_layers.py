"""POST /coverage with several cost layers over HTTP: each is an objective with a name."""

from itertools import permutations
from typing import Any

import httpx
import moocore
import numpy as np
import pytest
from paretour import Client

from tests.api.test_plan_coverage import GRID
from tests.helpers.serving import problem

PLACES = [[0, 0], [4, 0], [4, 5], [0, 5], [3, 2], [1, 2]]
NAMES = ["noise", "people", "wear"]


def layers(count: int, seed: int = 0) -> list[dict[str, Any]]:
    """As many cost layers with names."""
    rng = np.random.default_rng(seed)
    drawn = rng.integers(0, 9, (count, len(GRID), len(GRID[0]))).tolist()
    return [{"name": name, "layer": rows} for name, rows in zip(NAMES, drawn, strict=False)]


def task(count: int, **members: Any) -> dict[str, Any]:
    return {
        "grid": GRID,
        "cell_size": 0.5,
        "places": PLACES,
        "cost_layers": layers(count),
        "paths": True,
        **members,
    }


def costs_of(path: list[list[int]], layer: list[list[float]]) -> float:
    """What a path costs by a layer: each step its length times the mean at its ends."""
    cells = np.array(path)
    steps = 0.5 * np.hypot(*np.diff(cells, axis=0).T)
    costs = np.array(layer)[tuple(cells.T)]
    return float((steps * (costs[1:] + costs[:-1]) / 2).sum())


@pytest.mark.parametrize("count", [1, 2, 3])
def test_each_layer_is_an_objective_whose_costs_are_added_up_along_the_path(
    client: httpx.Client, count: int
) -> None:
    request = task(count)
    answer = client.post("/coverage", json=request).json()
    assert answer["objectives"] == [
        {"name": "distance", "unit": "m"},
        *({"name": name, "unit": None} for name in NAMES[:count]),
    ]
    for item in answer["front"]:
        path = item["path"]["cells"]
        summed = [costs_of(path, each["layer"]) for each in request["cost_layers"]]
        assert item["lengths"] == pytest.approx([item["path"]["metres"], *summed])


def test_the_front_is_that_of_all_tours(client: httpx.Client) -> None:
    legs = client.post("/coverage", json=task(2, places=PLACES[:2])).json()
    assert len(legs["front"]) == 1
    costs = np.zeros((3, len(PLACES), len(PLACES)))
    for i, j in permutations(range(len(PLACES)), 2):
        pair = {"places": [PLACES[i], PLACES[j]], "closed": False, "start": 0, "end": 1}
        answer = client.post("/coverage", json=task(2, **pair))
        assert answer.status_code == 200, answer.text
        [leg] = answer.json()["front"]
        costs[:, i, j] = leg["lengths"]
    tours = [(0, *rest, 0) for rest in permutations(range(1, len(PLACES)))]
    lengths = np.array([costs[:, tour[:-1], tour[1:]].sum(axis=1) for tour in tours])
    every = np.unique(moocore.filter_dominated(lengths).round(9), axis=0)
    answer = client.post("/coverage", json=task(2)).json()
    found = np.unique(np.array([item["lengths"] for item in answer["front"]]).round(9), axis=0)
    np.testing.assert_allclose(found, every)


def test_a_tour_is_chosen_by_the_names_of_layers(client: httpx.Client) -> None:
    with Client(str(client.base_url)) as paretour:
        front = paretour.coverage(**task(2))
        assert [objective.name for objective in front.objectives] == ["distance", *NAMES[:2]]
        least = front.lengths[:, 2].min()
        chosen = front.choose(at_most={"people": least}, prefer="distance")
        assert chosen.lengths[2] == least


def test_the_rest_is_planned_with_a_layer_anew(client: httpx.Client) -> None:
    answer = client.post("/coverage", json=task(2)).json()
    anew = {"name": "people", "layer": [[2] * 6] * 5}
    again = client.post(
        f"/front/{answer['id']}/replan", json={"cost_layers": [anew], "paths": True}
    )
    assert again.status_code == 200, again.text
    noise = layers(2)[0]["layer"]
    for item in again.json()["front"]:
        path = item["path"]["cells"]
        metres = item["path"]["metres"]
        expected = [metres, costs_of(path, noise), 2 * metres]
        assert item["lengths"] == pytest.approx(expected)


@pytest.mark.parametrize(
    ("members", "pointer", "sentence"),
    [
        ({"cost_layers": layers(2)[:1] * 2}, "/cost_layers/1/name", 'got "noise"'),
        ({"cost_layers": []}, "/cost_layers", "must have 1 item or more"),
        ({"cost_layers": [*layers(3), *layers(1)]}, "/cost_layers", "must have 3 items or fewer"),
        ({"cost_layers": [{"layer": GRID}]}, "/cost_layers/0/name", "is required"),
        ({"cost_layers": [{"name": "a", "layer": [[1]]}]}, "/cost_layers/0/layer", "as large as"),
        (
            {"cost_layers": [{"name": "a", "layer": [[1, 2], [1]]}]},
            "/cost_layers/0/layer/1",
            "must have 2 numbers, as the first, got 1",
        ),
        ({"cost_layers": [{"name": "a", "layer": []}]}, "/cost_layers/0/layer", "a row of numbers"),
        (
            {"cost_layers": [*layers(1), {"name": "a", "layer": [[1]]}]},
            "/cost_layers/1/layer",
            "as large as the first, 5 x 6 cells, got 1 x 1",
        ),
        (
            {"cost_layers": [{"name": "a", "layer": (-np.eye(5, 6)).tolist()}]},
            "/cost_layers/0/layer/0/0",
            "must be finite and not negative, got -1",
        ),
        ({"cost_layer": GRID}, "/cost_layers", "or cost_layer must be left out"),
        ({"second_coordinates": PLACES}, "/second_matrix", "only one of them"),
        ({"robots": [{"id": "a"}, {"id": "b"}]}, "/cost_layers", "must be left out with robots"),
        ({"reference_point": [9, 9]}, "/reference_point", "must have 3 numbers"),
    ],
)
def test_what_layers_cannot_be_is_refused(
    client: httpx.Client, members: dict[str, Any], pointer: str, sentence: str
) -> None:
    answer = client.post("/coverage", json=task(2, **members))
    document = problem(answer, 422, "invalid-request")
    [fault] = [each for each in document["errors"] if each["pointer"] == pointer]
    assert sentence in fault["detail"]


@pytest.mark.parametrize(
    ("asked", "members", "pointer", "sentence"),
    [
        ({}, {"cost_layers": layers(3)[2:]}, "/cost_layers/0/name", "one of noise, people, got"),
        ({}, {"cost_layer": GRID}, "/cost_layer", "must be one of cost_layers"),
        (
            {},
            {"cost_layers": [{"name": "noise", "layer": [[1]]}]},
            "/cost_layers/0/layer",
            "as large as grid",
        ),
        (
            {"cost_layers": None, "cost_layer": GRID},
            {"cost_layers": layers(1)},
            "/cost_layers",
            "the front has no layers with names",
        ),
    ],
)
def test_layers_anew_must_be_those_of_the_front(
    client: httpx.Client,
    asked: dict[str, Any],
    members: dict[str, Any],
    pointer: str,
    sentence: str,
) -> None:
    request = {name: each for name, each in task(2, **asked).items() if each is not None}
    answer = client.post("/coverage", json=request).json()
    refused = client.post(f"/front/{answer['id']}/replan", json=members)
    document = problem(refused, 422, "invalid-request")
    [fault] = document["errors"]
    assert fault["pointer"] == pointer
    assert sentence in fault["detail"]
