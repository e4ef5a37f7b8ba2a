"""Both clients plan for robots that share a map, and have the plans as values."""

import numpy as np
import pytest

from tests.helpers.answers import Connect

REQUEST = {
    "grid": np.array([[0, 0, 0, 0], [0, 1, 1, 0], [0, 0, 0, 0]]),
    "cell_size": 0.5,
    "places": [[0, 0], [2, 0], [2, 3], [0, 2]],
    "robots": [{"id": "left"}, {"id": "right", "start": 2}],
    "paths": True,
}


def test_plans_for_robots_are_values(connect: Connect, url: str) -> None:
    front = connect(url).robots(**REQUEST)
    assert front.status == "done"
    assert [each.unit for each in front.objectives] == ["m", "m"]
    assert front.places.tolist() == REQUEST["places"]
    assert front.lengths.tolist() == [plan.lengths.tolist() for plan in front.plans]
    for plan, item in zip(front.plans, front.document["front"], strict=True):
        for route, each in zip(plan.routes, item["routes"], strict=True):
            assert (route.robot, route.tour.tolist()) == (each["robot"], each["tour"])
            assert route.path.cells.tolist() == each["path"]["cells"]
            assert route.path.metres == pytest.approx(route.lengths[0])
    with pytest.raises(ValueError, match="read-only"):
        front.plans[0].routes[0].tour[0] = 1


def test_a_job_for_robots_is_found_by_its_id(connect: Connect, url: str) -> None:
    client = connect(url)
    job = client.submit_robots(**{**REQUEST, "paths": False})
    front = job.result()
    assert front.plans[0].routes[0].path is None
    assert client.robots_job(job.id).front().document == front.document
    assert front.reference_point.tolist() == front.document["reference_point"]
