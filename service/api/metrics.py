"""What the service counts of itself, for Prometheus."""

from collections.abc import Iterator
from typing import Protocol

from fastapi import APIRouter
from prometheus_client import (
    CollectorRegistry,
    Counter,
    GCCollector,
    Histogram,
    PlatformCollector,
    ProcessCollector,
    generate_latest,
)
from prometheus_client.exposition import CONTENT_TYPE_PLAIN_0_0_4
from prometheus_client.metrics_core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from starlette.responses import Response

from service.api.middleware import Answered
from service.jobs.engine import EngineStats
from service.jobs.front_document import FrontDocument

_METHODS = ("GET", "HEAD", "POST", "DELETE", "OPTIONS")
_SIZES = (20, 50, 100, 200, 500, 1000)
_SECONDS = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
_SHARES = (0.0, 0.0001, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3)


class Watched(Protocol):
    """What plans fronts."""

    async def stats(self) -> EngineStats:
        """How it is."""


class Metrics:
    """Counters and clocks, in a registry of their own."""

    def __init__(self) -> None:
        self._registry = registry = CollectorRegistry()
        ProcessCollector(registry=registry)
        PlatformCollector(registry=registry)
        GCCollector(registry=registry)
        self._requests = Counter(
            "paretour_requests",
            "requests answered",
            ["method", "path", "status"],
            registry=registry,
        )
        self._request_seconds = Histogram(
            "paretour_request_seconds",
            "from a request to the end of its answer",
            ["method", "path"],
            registry=registry,
            buckets=_SECONDS,
        )
        self._planning = Histogram(
            "paretour_planning_seconds",
            "planning, by its phase and the most cities of the class",
            ["phase", "cities"],
            registry=registry,
            buckets=_SECONDS,
        )
        self._watched: Watched | None = None
        self._workers = _WorkersCollector()
        registry.register(self._workers)
        self._gained = Histogram(
            "paretour_hypervolume_gained",
            "share of the reference box that the search added to what it was given",
            ["cities"],
            registry=registry,
            buckets=_SHARES,
        )

    def router(self) -> APIRouter:
        """The path where Prometheus asks."""
        router = APIRouter(tags=["service"])
        router.get("/metrics", response_class=_Exposition)(self.exposition)
        return router

    async def exposition(self) -> Response:
        """Give everything counted, in the text format of Prometheus."""
        if self._watched is not None:
            self._workers.standing = await self._watched.stats()
        return _Exposition(generate_latest(self._registry))

    def answered(self, answered: Answered) -> None:
        """Count a request."""
        # Whatever a client makes up must not become a label: each label costs memory for good.
        method = answered.method if answered.method in _METHODS else "other"
        self._requests.labels(method, answered.path, answered.status).inc()
        self._request_seconds.labels(method, answered.path).observe(answered.seconds)

    def watch(self, watched: Watched) -> None:
        """Ask how the workers are whenever Prometheus asks."""
        self._watched = watched

    def planned(self, front: FrontDocument) -> None:
        """Count a front: the phases of planning, and the hypervolume that the search gained."""
        cities = _size_class(front.cities)
        for phase, milliseconds in front.timings_ms.phases.items():
            self._planning.labels(phase, cities).observe(milliseconds / 1000)
        if front.gained is not None:
            self._gained.labels(cities).observe(front.gained)


class _WorkersCollector(Collector):
    def __init__(self) -> None:
        self.standing: EngineStats | None = None

    def collect(self) -> Iterator[Metric]:
        if (workers := self.standing) is None:
            return
        yield GaugeMetricFamily(
            "paretour_queue_depth", "fronts that wait for a worker", workers.waiting
        )
        yield GaugeMetricFamily(
            "paretour_workers_busy", "workers that plan a front", workers.working
        )
        yield CounterMetricFamily(
            "paretour_worker_restarts", "workers that were lost and replaced", workers.lost
        )


class _Exposition(Response):
    media_type = CONTENT_TYPE_PLAIN_0_0_4


def _size_class(n: int) -> str:
    return next((str(most) for most in _SIZES if n <= most), "more")
