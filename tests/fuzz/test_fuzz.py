"""Fuzzed bodies, from a seed: no answer is a fault of the service, and none takes much memory."""

import random
from collections.abc import Iterator

import httpx
import pytest

from tests.fuzz.attack import largest_memory, parse_many, post_many, strict_json
from tests.fuzz.bodies import GENERATORS, extreme
from tests.fuzz.fleets import extreme_fleet
from tests.helpers.sampled import sixth, tenth
from tests.helpers.serving import ACTORS, LIMITS, app_of, serving, workers_of

INFO = {actor.info.name: actor.info for actor in ACTORS}
COUNT = tenth(2000)
SAMPLE = sixth(15)
EXTREMES = tenth(500)


@pytest.mark.parametrize("name", GENERATORS)
def test_every_mutated_body_is_planned_or_refused(name: str) -> None:
    before = largest_memory()
    outcomes = parse_many(name, COUNT, 16, LIMITS, INFO)
    assert outcomes.total() == COUNT
    assert outcomes["planned"] > COUNT // 100
    assert len(outcomes) > 1
    assert largest_memory() - before < 300


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    workers, before = workers_of(), largest_memory()
    with serving(app_of(workers=workers)) as address:
        yield address
        assert workers.lost == 0
    assert largest_memory() - before < 500


def test_extreme_numbers_over_http_are_planned_or_refused(url: str) -> None:
    sources = (extreme(random.Random(f"extreme {number}")) for number in range(EXTREMES))
    statuses = post_many(url, sources)
    assert statuses.total() == EXTREMES
    assert set(statuses) == {200, 422}
    assert statuses[200] > EXTREMES // 5


def test_fleets_of_extreme_numbers_over_http_are_planned_or_refused(url: str) -> None:
    sources = [extreme_fleet(random.Random(f"extreme {number}")) for number in range(EXTREMES)]
    statuses = post_many(url, sources)
    assert statuses.total() == EXTREMES
    assert set(statuses) == {200, 422}
    assert statuses[200] > EXTREMES // 5


@pytest.mark.parametrize("name", sorted(set(GENERATORS) - {"multipart"}))
def test_a_sample_over_http_is_answered(url: str, name: str) -> None:
    sources = [GENERATORS[name](random.Random(number)) for number in range(SAMPLE)]
    assert post_many(url, sources).total() == SAMPLE  # type: ignore[arg-type]
    assert httpx.get(f"{url}/health/ready").status_code == 200


def test_what_is_no_strict_json_is_found() -> None:
    assert strict_json(b'{"a": 1e300}') == {"a": 1e300}
    for content in (b"NaN", b"[Infinity]", b'{"a": -Infinity}'):
        with pytest.raises(ValueError, match="is not JSON"):
            strict_json(content)
