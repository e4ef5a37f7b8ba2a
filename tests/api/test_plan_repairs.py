"""Repairs of the released networks, over HTTP."""

from typing import Any

import httpx
import numpy as np
import pytest

from service.construction.repairs import repairs_worth
from service.instance import Kind
from service.settings import Settings

N = 30
CITIES = np.random.default_rng(0).random((N, 4))
MATRICES = np.random.default_rng(1).random((2, N, N))
STOPS: dict[str, Any] = {
    "stops": [{"id": f"stop {i}"} for i in range(N)],
    "objectives": [
        {"name": "plane", "coordinates": CITIES[:, :2].tolist()},
        {"name": "table", "matrix": MATRICES[0].tolist()},
    ],
}
COVERAGE: dict[str, Any] = {
    "grid": np.zeros((5, 6), np.int64).tolist(),
    "cell_size": 1,
    "places": [[row, column] for row in range(5) for column in range(6)],
    "second_coordinates": CITIES[:, 2:].tolist(),
}
ALONE = {"time_limit": 0, "preferences": 20}
REQUESTS = {
    "coordinates": ("/front", {"coordinates": CITIES.tolist()}),
    "matrices": ("/front", {"matrices": MATRICES.tolist()}),
    "stops": ("/front", STOPS),
    "open": ("/front", {**STOPS, "closed": False, "start": "stop 3", "end": None}),
    "coverage": ("/coverage", COVERAGE),
}


def asked(url: str, path: str, body: dict[str, Any]) -> dict[str, Any]:
    answer = httpx.post(url + path, json=body, timeout=300)
    assert answer.status_code == 200, answer.text
    document: dict[str, Any] = answer.json()
    return document


@pytest.mark.parametrize("kind", REQUESTS)
def test_repairs_make_the_networks_front_better(released: str, kind: str) -> None:
    path, body = REQUESTS[kind]
    plain = asked(released, path, {**body, **ALONE, "repairs": 0})
    repaired = asked(released, path, {**body, **ALONE, "repairs": 4})
    assert repaired["hypervolume"] > plain["hypervolume"]


@pytest.mark.parametrize("kind", ["coordinates", "matrices"])
def test_without_a_time_limit_the_network_repairs_by_default(released: str, kind: str) -> None:
    path, body = REQUESTS[kind]
    inputs: Kind = "matrices" if kind == "matrices" else "coordinates"
    repairs = repairs_worth(inputs, N, objectives=2)
    by_default = asked(released, path, {**body, **ALONE, "augment": 8})
    as_many = asked(released, path, {**body, **ALONE, "repairs": repairs})
    assert by_default["front"] == as_many["front"]


def test_what_is_left_of_a_way_is_repaired_as_well(released: str) -> None:
    front = asked(released, "/front", {**STOPS, "time_limit": 0, "repairs": 0})
    rest = {"done": ["stop 0"], "add": [], "time_limit": 0}
    plain, repaired = (
        asked(released, f"/front/{front['id']}/replan", {**rest, "repairs": repairs})
        for repairs in (0, 4)
    )
    assert repaired["hypervolume"] > plain["hypervolume"]


def test_more_repairs_than_the_setting_allows_are_refused(released: str) -> None:
    most = Settings().max_repairs
    path, body = REQUESTS["coordinates"]
    answer = httpx.post(released + path, json={**body, "repairs": most + 1})
    assert answer.status_code == 422
    assert answer.json()["code"] == "over-limit"
    assert (answer.json()["limit"], answer.json()["actual"]) == (most, most + 1)
    assert answer.json()["errors"][0]["pointer"] == "/repairs"
