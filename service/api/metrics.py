"""Metrics for Prometheus: requests, planning, and the workers of the engine."""

from collections.abc import Callable, Iterator
from functools import cache, partial
from typing import TypeVar

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

from service.api.middleware import AnsweredRequest
from service.jobs.engine import Engine, EngineStats
from service.kinds.front_document import FrontDocument
from service.kinds.table import KINDS

AnyMetric = TypeVar("AnyMetric", Counter, Histogram)
_METHODS = ("GET", "HEAD", "POST", "DELETE", "OPTIONS")
_SIZES = (20, 50, 100, 200, 500, 1000)  # the most cities of each class
_SECONDS = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
_SHARES = (0.0, 0.0001, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3)


class Metrics(Collector):
    """Counters and histograms of one service, in a registry of their own."""

    def __init__(self) -> None:
        self._registry = registry = CollectorRegistry()
        ProcessCollector(registry=registry)
        PlatformCollector(registry=registry)
        GCCollector(registry=registry)
        counter = partial(Counter, registry=registry)
        histogram = partial(Histogram, registry=registry, buckets=_SECONDS)
        self._requests = _children(
            counter("paretour_requests", "requests answered", ["method", "path", "status"])
        )
        self._request_seconds = _children(
            histogram(
                "paretour_request_seconds",
                "from a request to the end of its answer",
                ["method", "path"],
            )
        )
        self._fronts = _children(
            counter(
                "paretour_fronts",
                "fronts planned, by their kind and by why the search ended",
                ["of", "terminated"],
            )
        )
        self._planning = _children(
            histogram(
                "paretour_planning_seconds",
                "planning, by its phase and the most cities of the class",
                ["phase", "cities"],
            )
        )
        self._gained = histogram(
            "paretour_hypervolume_gained",
            "share of the reference box that the search added to its initial tours",
            ["cities"],
            buckets=_SHARES,
        )
        self._router_requests = counter(
            "paretour_router_requests",
            "questions to the routing engine, by their outcome",
            ["outcome"],
        )
        self._router_seconds = histogram(
            "paretour_router_seconds", "one question to the routing engine"
        )
        self._webhooks = counter(
            "paretour_webhooks", "attempts to post to a webhook, by their outcome", ["outcome"]
        )
        self._engine: Engine | None = None
        self._stats: EngineStats | None = None  # at the last scrape
        registry.register(self)

    def router(self) -> APIRouter:
        """Return the route that Prometheus scrapes."""
        router = APIRouter(tags=["service"])
        router.get("/metrics", operation_id="get_metrics", response_class=_Exposition)(
            self.exposition
        )
        return router

    async def exposition(self) -> Response:
        """Return all metrics in the text format of Prometheus."""
        if self._engine is not None:
            self._stats = await self._engine.stats()
        return _Exposition(generate_latest(self._registry))

    def collect(self) -> Iterator[Metric]:
        """Yield the gauges and the counter of the engine's workers."""
        if (stats := self._stats) is None:
            return
        yield GaugeMetricFamily(
            "paretour_queue_depth", "fronts that wait for a worker", stats.waiting
        )
        yield GaugeMetricFamily("paretour_workers", "workers that are alive", stats.workers)
        yield GaugeMetricFamily("paretour_workers_busy", "workers that plan a front", stats.working)
        yield CounterMetricFamily(
            "paretour_worker_restarts", "workers that were lost and replaced", stats.lost
        )

    def answered(self, answered: AnsweredRequest) -> None:
        """Count a request that was answered."""
        # An invented method must not become a label: each label takes memory until the end.
        method = answered.method if answered.method in _METHODS else "other"
        self._requests(method, answered.path, answered.status).inc()
        self._request_seconds(method, answered.path).observe(answered.seconds)

    def watch(self, engine: Engine) -> None:
        """Report the workers of an engine at each scrape."""
        self._engine = engine

    def routed(self, outcome: str, seconds: float) -> None:
        """Count a question to the routing engine: answered, unavailable or unusable."""
        self._router_requests.labels(outcome).inc()
        self._router_seconds.observe(seconds)

    def posted(self, outcome: str) -> None:
        """Count an attempt to post to a webhook: delivered, failed or given-up."""
        self._webhooks.labels(outcome).inc()

    def planned(self, front: FrontDocument) -> None:
        """Count a planned front, its phases, and the hypervolume that the search gained."""
        self._fronts(KINDS[front.kind].label, front.terminated).inc()
        cities = _size_class(front.cities)
        for phase, milliseconds in front.phases.items():
            self._planning(phase, cities).observe(milliseconds / 1000)
        if front.gained is not None:
            self._gained.labels(cities).observe(front.gained)


def _children(metric: AnyMetric) -> Callable[..., AnyMetric]:
    """Return a function that finds the child of a metric with given labels.

    It remembers the children: to look one up takes longer than to count in it.
    """
    return cache(metric.labels)


class _Exposition(Response):
    media_type = CONTENT_TYPE_PLAIN_0_0_4


def _size_class(n: int) -> str:
    return next((str(most) for most in _SIZES if n <= most), "more")
