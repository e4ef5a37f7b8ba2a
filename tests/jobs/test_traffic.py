"""Fronts over the historical traffic of a routing engine; a stand-in has some traffic."""

from collections.abc import Iterator
from typing import Any

import httpx
import numpy as np
import pytest

from service.server import Ending, build
from service.settings import Settings
from tests.helpers.fake_traffic import FakeTraffic, fake_traffic, seconds_at
from tests.helpers.processes import UNLIMITED
from tests.helpers.serving import problem, serving

HOUR = 3600
AT = [6 * HOUR, 7 * HOUR, 9.5 * HOUR]
TIMES = ["2026-11-30T06:00", "2026-11-30T07:00", "2026-11-30T09:30"]
PLACES = np.random.default_rng(1).uniform((24.0, 60.0), (24.1, 60.1), (7, 2)).round(6)
TRAFFIC = {"name": "time", "from": "road_time", "traffic": {"date": "2026-11-30", "at": AT}}
RISK = {"name": "risk", "matrix": np.random.default_rng(2).integers(1, 9, (7, 7)).tolist()}


def request(*objectives: dict[str, Any], **more: Any) -> dict[str, Any]:
    """A request over the traffic, or under other objectives."""
    stops = [{"id": f"order-{i}", "location": each} for i, each in enumerate(PLACES.tolist())]
    return {
        "stops": stops,
        "objectives": [*(objectives or (TRAFFIC, RISK))],
        "departure": {"earliest": 6 * HOUR, "latest": 8 * HOUR},
        "time_limit": 0.1,
        "seed": 1,
        **more,
    }


@pytest.fixture(scope="module")
def engine() -> Iterator[FakeTraffic]:
    with fake_traffic() as fake:
        yield fake


@pytest.fixture(scope="module")
def url(engine: FakeTraffic) -> Iterator[str]:
    settings = Settings(workers=1, rate=UNLIMITED, router_url=engine.url, router_traffic=True)
    with serving(build(settings, Ending())) as url:
        yield url


def test_a_front_is_that_of_the_traffic_at_each_time(url: str, engine: FakeTraffic) -> None:
    engine.asked.clear()
    answer = httpx.post(f"{url}/front", json=request()).json()
    assert [each["date_time"]["value"] for each in engine.asked] == TIMES
    assert all(each["prioritize_bidirectional"] for each in engine.asked)
    slices = [
        {"from": from_, "matrix": seconds_at(PLACES, time).tolist()}
        for from_, time in zip(AT, TIMES, strict=True)
    ]
    same = request({"name": "time", "unit": "s", "slices": slices}, RISK)
    expected = httpx.post(f"{url}/front", json=same).json()
    assert answer["front"] == expected["front"]
    assert answer["objectives"] == expected["objectives"]
    assert answer["timings_ms"]["roads"] > 0
    httpx.post(f"{url}/front", json=request())
    assert len(engine.asked) == 3  # the answers are remembered


def test_the_rest_is_planned_by_the_traffic_then(url: str, engine: FakeTraffic) -> None:
    front = httpx.post(f"{url}/front", json=request()).json()
    engine.asked.clear()
    new = {"id": "order-new", "location": [24.05, 60.05], "costs": [None, {"to": [1] * 8}]}
    body = {"done": ["order-0"], "now": 8 * HOUR, "add": [new]}
    rest = httpx.post(f"{url}/front/{front['id']}/replan", json=body).json()
    assert [each["date_time"]["value"] for each in engine.asked] == TIMES
    assert all("order-new" in each["stops"] for each in rest["front"])
    costs = [{"objective": "time", "from": "order-1", "to": "order-2", "cost": 1}]
    refused = httpx.post(f"{url}/front/{front['id']}/replan", json={**body, "costs": costs})
    assert '"time"' in problem(refused, 422, "invalid-request")["detail"]


def test_a_service_without_traffic_says_so(engine: FakeTraffic) -> None:
    settings = Settings(workers=1, rate=UNLIMITED, router_url=engine.url)
    with serving(build(settings, Ending())) as url:
        refused = problem(httpx.post(f"{url}/front", json=request()), 422, "no-traffic")
    assert refused["errors"][0]["pointer"] == "/objectives/0/traffic"


def test_an_osrm_has_no_traffic(engine: FakeTraffic) -> None:
    settings = Settings(router_url=engine.url, router="osrm", router_traffic=True)
    with pytest.raises(ValueError, match="PARETOUR_ROUTER_TRAFFIC needs PARETOUR_ROUTER=valhalla"):
        build(settings, Ending())


@pytest.mark.parametrize(
    ("pointer", "changed"),
    [
        ("traffic/date", {"traffic": {"date": "tomorrow", "at": AT}}),
        ("traffic/date", {"traffic": {"date": "9999-12-31", "at": AT}}),
        ("traffic/at", {"traffic": {"date": "2026-11-30", "at": []}}),
        ("traffic/at/1", {"traffic": {"date": "2026-11-30", "at": [HOUR, HOUR]}}),
        ("traffic/at/0", {"traffic": {"date": "2026-11-30", "at": [HOUR + 1]}}),
        ("traffic/at/0", {"traffic": {"date": "2026-11-30", "at": [-60]}}),
        ("traffic", {"over_the_day": [[0, 2]]}),
        ("traffic", {"from": "road_distance"}),
        ("traffic", {"from": None, "matrix": RISK["matrix"]}),
        (
            "traffic",
            {"from": None, "slices": [{"from": 0, "matrix": RISK["matrix"]}]},
        ),
    ],
)
def test_what_is_no_traffic_is_refused(url: str, pointer: str, changed: dict[str, Any]) -> None:
    merged = {**TRAFFIC, **changed}
    objective = {name: value for name, value in merged.items() if value is not None}
    refused = httpx.post(f"{url}/front", json=request(objective, RISK))
    found = problem(refused, 422, "invalid-request")["errors"][0]["pointer"]
    assert found.startswith(f"/objectives/0/{pointer}"), refused.text


def test_a_request_cannot_ask_for_more_times_than_are_kept(url: str) -> None:
    n = 600
    stops = [{"id": str(i), "location": [24 + i / n, 60]} for i in range(n)]
    traffic = {**TRAFFIC, "traffic": {"date": "2026-11-30", "at": [60 * k for k in range(100)]}}
    body = request(traffic, {"name": "way", "from": "great_circle"}, stops=stops)
    refused = problem(httpx.post(f"{url}/front", json=body), 422, "invalid-request")
    assert "must have at most 23 times for 600 stops, got 100" in refused["detail"]
