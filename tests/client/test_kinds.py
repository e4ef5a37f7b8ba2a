"""A job whose kind is not known gives a front of the class of its kind."""

import numpy as np
import pytest
from paretour import Front, UnexpectedAnswer

from tests.client.test_robots import REQUEST as ROBOTS
from tests.helpers.answers import FRONT, Answers, Connect, front
from tests.helpers.fleet_requests import fleet_request

CITIES = np.random.default_rng(5).random((8, 4))
MAP = {name: ROBOTS[name] for name in ("grid", "cell_size", "places")}


def test_the_job_of_any_front_gives_what_its_kind_says(connect: Connect, url: str) -> None:
    client = connect(url)
    costs = np.ones((len(MAP["places"]), 2))
    found = {
        "front": client.front(coordinates=CITIES),
        "coverage": client.coverage(**MAP, second_coordinates=costs),
        "fleet": client.fleet(**fleet_request()),
        "robots": client.robots(**ROBOTS),
    }
    for kind, planned in found.items():
        again = client.any_job(planned.id).front()
        assert (type(again), again.document["kind"]) == (type(planned), kind)
        assert again.document == planned.document


def test_the_front_of_a_service_that_says_no_kind_is_of_tours(connect: Connect) -> None:
    found = connect(transport=Answers(front())).any_job("f").front()
    assert isinstance(found, Front)
    assert found.document == FRONT


def test_a_kind_that_is_not_known_is_unexpected(connect: Connect) -> None:
    known = "front, coverage, fleet, robots"
    with pytest.raises(UnexpectedAnswer, match=f"kind must be one of {known}, got 'boat'"):
        connect(transport=Answers(front(kind="boat"))).any_job("f").front()
