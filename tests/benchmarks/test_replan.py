"""The benchmark of replanning: both ways plan the same rest, and are measured by the same box."""

import json

import numpy as np
import pytest

from service.instance import Instance
from service.requests.limits import Limits
from service.requests.replan.earlier_front import StoredFront
from service.requests.replan.parser import ReplanSource, parse_replan
from service.requests.task import TaskSource
from tests.benchmarks.replan import _changes, share_of
from tests.helpers.actors import info_of

LIMITS = Limits(body_bytes=2**20, cities=50, cells=100, preferences=99, size=99, seconds=9)


def test_the_rest_from_nothing_has_the_cities_and_ends_of_the_rest_that_is_replanned() -> None:
    generator = np.random.default_rng(1)
    cities = generator.random((30, 4))
    tours = [[0, *generator.permutation(np.arange(1, 30)).tolist()] for _ in range(3)]
    front = {"front": [{"balance": each / 2, "tour": tours[each]} for each in range(3)]}
    changes, rest = _changes(front, cities, 2, generator)
    items = [{"tour": tour, "lengths": [1.0, 2.0]} for tour in tours]
    source = TaskSource("front", json.dumps({"coordinates": cities.tolist()}).encode())
    stored = StoredFront("a", source, json.dumps(items)[1:-1].encode())
    body = json.dumps(changes).encode()
    task = parse_replan(ReplanSource(body, stored), LIMITS, {"a": info_of("a", "matrices")}).task
    assert task is not None
    instance = task.subject
    assert isinstance(instance, Instance)
    assert instance.coordinates is not None
    other = np.array(rest["coordinates"])
    assert sorted(instance.coordinates.tolist()) == sorted(other.tolist())
    for end in ("start", "end"):
        city = instance.coordinates[getattr(instance, end)]
        assert city.tolist() == other[rest[end]].tolist()


def test_the_share_of_a_front_is_that_of_its_hypervolume_in_its_own_box() -> None:
    best = np.array([[0.0, 4.0], [2.0, 2.0], [4.0, 0.0]])
    assert share_of(best, best) == pytest.approx(1.0)
    assert share_of(best[:1], best) == pytest.approx(0.0, abs=1e-6)
    assert share_of(best + np.array([0.0, 1.0]), best) == pytest.approx(0.5)
    assert share_of(best - 1.0, best) > 1.0
