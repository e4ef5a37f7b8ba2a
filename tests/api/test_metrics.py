"""What Prometheus is told, against a live server."""

from dataclasses import dataclass, replace
from typing import get_args

import httpx
import numpy as np
from prometheus_client.parser import text_string_to_metric_families

from service.api.app import Edge
from service.api.metrics import Metrics
from service.jobs.engine import EngineStats
from service.kinds.front_document import FrontDocument
from service.requests.task import KindName
from tests.helpers.actors import Broken
from tests.helpers.serving import app_of, serving, serving_settings

FOUND = FrontDocument(
    kind="front",
    cities=3,
    points=1,
    hypervolume=0.5,
    hypervolume_bound=None,
    reference_point=[1.0, 1.0],
    scale=[1.0, 1.0],
    timings_ms={},
    terminated="converged",
    actor=None,
)
FRONT = {"coordinates": [[0, 0, 1, 3], [2, 5, 0, 0], [4, 1, 2, 2]], "time_limit": 0}


def samples(url: str) -> dict[tuple[str, ...], float]:
    """The value of each sample, by its name and its labels' values in the order of their names."""
    answer = httpx.get(f"{url}/metrics")
    assert answer.headers["content-type"].startswith("text/plain; version=0.0.4")
    return {
        (sample.name, *(value for _, value in sorted(sample.labels.items()))): sample.value
        for family in text_string_to_metric_families(answer.text)
        for sample in family.samples
    }


def test_requests_are_counted_by_the_path_that_they_matched() -> None:
    with serving(app_of()) as url:
        for _ in range(3):
            httpx.post(f"{url}/front", json=FRONT)
        httpx.get(f"{url}/front/none")
        httpx.get(f"{url}/nowhere/at/all")
        for path in ("", "/guide/limits", "/guide/none", "/page/style.css", "/docs"):
            httpx.get(url + path)
        httpx.post(f"{url}/files", files={"file": ("a.csv", b"id,lat,lon\na,60,24\nb,61,24\n")})
        httpx.request("BREW", f"{url}/front")
        counted = samples(url)
    requests = {key[1:]: value for key, value in counted.items() if key[0].endswith("s_total")}
    assert requests["POST", "/front", "200"] == 3
    assert requests["GET", "/front/{id}", "404"] == 1
    assert requests["GET", "unmatched", "404"] == 1
    assert requests["other", "/front", "405"] == 1
    assert requests["GET", "/", "200"] == requests["GET", "/docs", "200"] == 1
    assert requests["GET", "/guide/{name}", "200"] == requests["GET", "/guide/{name}", "404"] == 1
    assert requests["GET", "/page/{path:path}", "200"] == 1
    assert requests["POST", "/files", "200"] == 1
    assert counted["paretour_request_seconds_count", "POST", "/front"] == 3


def test_a_bug_is_counted() -> None:
    with serving(app_of(Broken())) as url:
        httpx.post(f"{url}/front", json=FRONT)
        assert samples(url)["paretour_requests_total", "POST", "/front", "500"] == 1


@dataclass
class FixedStats:
    """An engine that gives the statistics it is given."""

    now: EngineStats

    async def stats(self) -> EngineStats:
        return self.now


def test_the_workers_are_asked_whenever_prometheus_asks() -> None:
    engine = FixedStats(EngineStats(waiting=3, working=2, lost=1, workers=4))
    metrics = Metrics()
    metrics.watch(engine)
    with serving(app_of(edge=Edge(metrics=metrics))) as url:
        counted = samples(url)
        engine.now = EngineStats(waiting=0, working=2, lost=1, workers=4)
        later = samples(url)
    assert counted["paretour_queue_depth",] == 3
    assert counted["paretour_workers",] == 4
    assert counted["paretour_workers_busy",] == 2
    assert counted["paretour_worker_restarts_total",] == 1
    assert later["paretour_queue_depth",] == 0


def test_fronts_of_tours_of_fleets_and_of_robots_are_counted_apart() -> None:
    metrics = Metrics()
    kinds: tuple[KindName, ...] = get_args(KindName)
    for kind in kinds:
        metrics.planned(replace(FOUND, kind=kind))
    with serving(app_of(edge=Edge(metrics=metrics))) as url:
        counted = samples(url)
    assert counted["paretour_fronts_total", "tours", "converged"] == 2
    assert counted["paretour_fronts_total", "fleet", "converged"] == 1
    assert counted["paretour_fronts_total", "robots", "converged"] == 1


def test_fronts_are_counted_by_phase_and_size_class(quick_actors: dict[str, str]) -> None:
    with serving_settings({"PARETOUR_WORKERS": "1", **quick_actors}, warm=True) as url:
        for n, seconds in [(12, 1.0), (12, 0.0), (60, 0.0)]:
            cities = np.random.default_rng(n).random((n, 4)).tolist()
            request = {"coordinates": cities, "time_limit": seconds, "preferences": 5}
            answer = httpx.post(f"{url}/front", json=request, timeout=300)
            assert answer.status_code == 200
        counted = samples(url)
    assert counted["paretour_workers",] == 1
    for phase in ("construction", "improvement", "selection", "bound"):
        assert counted["paretour_planning_seconds_count", "20", phase] == 2
        assert counted["paretour_planning_seconds_count", "100", phase] == 1
    assert counted["paretour_planning_seconds_sum", "20", "improvement"] >= 0.01
    assert counted["paretour_hypervolume_gained_count", "20"] == 1
    assert 0 < counted["paretour_hypervolume_gained_sum", "20"] < 1
    assert ("paretour_hypervolume_gained_count", "100") not in counted
    assert counted["paretour_queue_depth",] == 0
    assert counted["paretour_worker_restarts_total",] == 0
    assert counted["process_resident_memory_bytes",] > 1e6
