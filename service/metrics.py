"""What the service counts of itself, for Prometheus."""

from collections.abc import Callable, Mapping

from fastapi import APIRouter
from prometheus_client import (
    CollectorRegistry,
    Counter,
    Gauge,
    GCCollector,
    Histogram,
    PlatformCollector,
    ProcessCollector,
    generate_latest,
)
from prometheus_client.exposition import CONTENT_TYPE_PLAIN_0_0_4
from starlette.responses import Response

from service.observed import Answered

_METHODS = ("GET", "HEAD", "POST", "DELETE", "OPTIONS")
_SIZES = (20, 50, 100, 200, 500, 1000)
_SECONDS = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
_SHARES = (0.0, 0.0001, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3)


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
        self._queue = Gauge(
            "paretour_queue_depth", "plans that wait for a worker", registry=registry
        )
        self._planning = Histogram(
            "paretour_planning_seconds",
            "planning, by its phase and the most cities of the class",
            ["phase", "cities"],
            registry=registry,
            buckets=_SECONDS,
        )
        self._gained = Histogram(
            "paretour_hypervolume_gained",
            "share of the reference box that the search added to what it was given",
            ["cities"],
            registry=registry,
            buckets=_SHARES,
        )
        self._restarts = Counter(
            "paretour_worker_restarts", "workers that ended and were replaced", registry=registry
        )

    def router(self) -> APIRouter:
        """The path where Prometheus asks."""
        router = APIRouter(tags=["service"])
        router.get("/metrics", response_class=_Exposition)(self.exposition)
        return router

    async def exposition(self) -> Response:
        """Everything counted, in the text format of Prometheus."""
        return _Exposition(generate_latest(self._registry))

    def answered(self, answered: Answered) -> None:
        """Count a request."""
        # Whatever a client makes up must not become a label: each label costs memory for good.
        method = answered.method if answered.method in _METHODS else "other"
        self._requests.labels(method, answered.path, answered.status).inc()
        self._request_seconds.labels(method, answered.path).observe(answered.seconds)

    def watch_queue(self, depth: Callable[[], float]) -> None:
        """Ask how many plans wait whenever Prometheus asks."""
        self._queue.set_function(depth)

    def planned(self, n: int, milliseconds: Mapping[str, float], gained: float | None) -> None:
        """Count a plan of n cities: its phases, and the hypervolume that the search gained."""
        cities = _size_class(n)
        for phase, each in milliseconds.items():
            self._planning.labels(phase, cities).observe(each / 1000)
        if gained is not None:
            self._gained.labels(cities).observe(gained)

    def worker_restarted(self) -> None:
        """Count a worker that ended and was replaced."""
        self._restarts.inc()


class _Exposition(Response):
    media_type = CONTENT_TYPE_PLAIN_0_0_4


def _size_class(n: int) -> str:
    return next((str(most) for most in _SIZES if n <= most), "more")
