"""Build and run the service, or a worker of the cluster, as the settings say."""

import asyncio
import gc
import logging
import multiprocessing
import signal
import sys
from collections.abc import Callable, Coroutine, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from functools import partial
from socket import socket
from types import FrameType
from typing import NoReturn

import uvicorn
from fastapi import FastAPI
from uvicorn.config import STARTUP_FAILURE

from service import installed_version
from service.actor_info import RELEASED, ActorInfo, read_actor_infos
from service.api.app import Edge, create_app
from service.api.auth import Access, Rates
from service.api.metrics import Metrics
from service.api.site.tiles import Tiles
from service.api.task_parser import ParserBounds
from service.api.transport.connections import ConnectionLimits, Connections
from service.api.transport.listener import bound_sockets, most_connections
from service.api.transport.protocol import Connection
from service.api.transport.proxies import TrustedProxies
from service.cluster import check_cluster
from service.errors import NoWorker
from service.extensions.constructors import constructor_infos, load_constructors
from service.extensions.names import NO_EXTENSIONS
from service.jobs.engine import Engine
from service.jobs.local_engine import LocalEngine
from service.jobs.sqlite_store import SqliteStore
from service.jobs.store import Store
from service.jobs.workers.worker_pool import WorkerPool
from service.jobs.workers.worker_process import MakeRunner, make_runner
from service.mcp import check_mcp
from service.requests.road_measurer import measured_by_road
from service.roads.client import RoadClient
from service.settings import Settings
from service.telemetry import configure_logging, log_loading, logged, logging_every, trace
from service.webhooks.sender import Webhooks

_ACCEPTED_AT_ONCE = 32  # in a turn of the event loop: more would delay all other connections
_IN_KERNEL = 1024  # connections that wait until they are accepted


class Ending:
    """How the process of the service ends: by a signal, or because it cannot start.

    Attributes:
        back_up: What another signal, SIGUSR1, has the process do: back up its store, if it has one.
    """

    def __init__(self) -> None:
        self._status = 0
        self.back_up: Callable[[], Coroutine[None, None, None]] | None = None

    def exit(self, _signal: int, _frame: FrameType | None) -> NoReturn:
        """Exit. This is the handler of a signal."""
        sys.exit(self._status)

    def fail(self, reason: str) -> None:
        """Shut the service down, with the status of a start that has failed."""
        logging.getLogger("paretour").critical("the service cannot start: %s", reason)
        self._status = STARTUP_FAILURE
        signal.raise_signal(signal.SIGTERM)


def build(settings: Settings, ending: Ending) -> FastAPI:
    """Return the application of the service, which shuts down if no worker gets ready.

    Raises:
        ValueError: No actor is found, the store cannot be opened, Redis does not answer, or an
            extra is not installed.
    """
    if settings.mcp:
        check_mcp()
    infos = _checked_actors(settings)
    metrics = Metrics()
    roads = None if settings.roads is None else RoadClient(settings.roads, metrics.routed)
    if settings.redis_url is None:
        store, engine = _local_engine(settings, metrics, roads, ending)
    else:
        store, engine = _redis_engine(settings, metrics)
    metrics.watch(engine)
    app = create_app(
        infos,
        store,
        engine,
        settings.limits,
        installed_version(),
        Edge(
            access=Access(settings.api_keys, Rates(settings.rate, settings.redis_url)),
            metrics=metrics,
            origins=settings.origins,
            body_seconds=settings.body_seconds,
            request_seconds=settings.request_seconds,
            bodies_bytes=settings.bodies_bytes,
            share=settings.caller_share,
            parser=ParserBounds(seconds=settings.parse_seconds, memory=settings.parse_bytes),
            measure=None if roads is None else partial(measured_by_road, client=roads),
            streets=roads,
            tiles=Tiles(settings.tiles, settings.tiles_credit),
            agents=settings.mcp,
            webhooks=_webhooks(settings, metrics),
        ),
    )
    if settings.traces:
        trace(app)
    log_loading(app, engine.check_ready, lambda: engine.compiling)
    return app


def _webhooks(settings: Settings, metrics: Metrics) -> Webhooks | None:
    if (targets := settings.webhooks) is None:
        return None
    return Webhooks(targets=targets, secrets=settings.webhook_secrets, observe=metrics.posted)


def serve(app: FastAPI, settings: Settings, ending: Ending) -> None:
    """Serve requests until told to stop."""
    signal.signal(signal.SIGUSR1, signal.SIG_IGN)  # until the server can back up
    # Without a handler, uvicorn ends by the signal and the exit status says so.
    signal.signal(signal.SIGTERM, ending.exit)
    # Loaded modules stay; a collection that goes through them blocks the event loop for 40 ms.
    gc.collect()
    gc.freeze()
    most = most_connections(settings.connections, settings.workers)
    connections = Connections(
        ConnectionLimits(
            connections=most,
            share=settings.connection_share,
            proxies=settings.forwarded_allow_ips,
            head_seconds=settings.head_seconds,
        )
    )
    configure_logging(plain=sys.stderr.isatty())
    server = make_server(app, connections, settings.drain_seconds, settings.root_path or "")
    server.on_back_up = ending.back_up
    try:
        sockets = bound_sockets(settings.host, settings.port)
    except OSError as error:
        logging.getLogger("paretour").error(
            "cannot listen at %s, port %d: %s", settings.host, settings.port, error
        )
        sys.exit(STARTUP_FAILURE)
    with suppress(KeyboardInterrupt):
        server.run(sockets)


class Server(uvicorn.Server):
    """A server whose kernel holds more connections than it accepts in a turn of its event loop.

    Attributes:
        on_back_up: What to do at SIGUSR1.
    """

    on_back_up: Callable[[], Coroutine[None, None, None]] | None = None

    async def startup(self, sockets: list[socket] | None = None) -> None:
        """Start the application, then accept the connections of these sockets."""
        await super().startup(sockets)
        if self.on_back_up is not None:
            loop = asyncio.get_running_loop()
            loop.add_signal_handler(signal.SIGUSR1, self._back_up, self.on_back_up)
        for listening in sockets or []:
            listening.listen(_IN_KERNEL)

    def _back_up(self, act: Callable[[], Coroutine[None, None, None]]) -> None:
        self._backing_up = asyncio.create_task(act())  # kept, as a task that nobody has may go


def make_server(
    app: FastAPI, connections: Connections, drain_seconds: int, root_path: str = ""
) -> Server:
    """Return a server of HTTP/1.1 alone, over these connections.

    Args:
        connections: The connections, and the proxies that are trusted.
        drain_seconds: What requests in progress have at the end.
        root_path: The path that a proxy takes away from those of all requests.
    """
    config = uvicorn.Config(
        TrustedProxies(app, connections.limits.proxies),  # type: ignore[arg-type]
        root_path=root_path,
        http=partial(Connection, connections),  # type: ignore[arg-type]  # called like a class
        ws="none",
        # Not uvloop: 1 % more answers, but it does not shut down while Redis is connected.
        loop="asyncio",
        proxy_headers=False,  # TrustedProxies reads them
        server_header=False,
        log_config=None,
        access_log=False,
        timeout_graceful_shutdown=drain_seconds,
        backlog=_ACCEPTED_AT_ONCE,
    )
    return Server(config)


def build_worker(settings: Settings) -> Callable[[], int]:
    """Return a function that runs a worker of the cluster and returns its exit status.

    Raises:
        ValueError: PARETOUR_REDIS_URL is not set, Redis does not answer, or the extra is not
            installed.
    """
    redis_url = _redis_url(settings)
    from service.cluster.celery_app import make_celery
    from service.cluster.script import wait_for_redis
    from service.cluster.worker import CeleryWorker, RecordWorker

    wait_for_redis(redis_url)
    _checked_actors(settings)
    configure_logging()
    worker = CeleryWorker(
        celery=make_celery(redis_url, settings.request_seconds),
        records=RecordWorker(
            _make_runner(settings),
            redis_url,
            workers=settings.workers,
            seconds=settings.request_seconds,
            roads=None if settings.roads is None else RoadClient(settings.roads),
        ),
        drain_seconds=settings.drain_seconds,
    )

    def run() -> int:
        try:
            with logging_every("the search is being loaded or compiled"):
                worker.start()
        except NoWorker as error:
            logging.getLogger("paretour").critical("the worker cannot start: %s", error)
            return STARTUP_FAILURE
        return worker.run()

    return run


def takes_work(settings: Settings) -> bool:
    """Return whether this machine's worker takes the jobs that wait.

    Raises:
        ValueError: PARETOUR_REDIS_URL is not set, or the extra is not installed.
    """
    redis_url = _redis_url(settings)
    from service.cluster import worker_store

    return asyncio.run(worker_store.takes_work(redis_url))


def _local_engine(
    settings: Settings,
    metrics: Metrics,
    roads: RoadClient | None,
    ending: Ending,
) -> tuple[Store, Engine]:
    """Return the store in SQLite, and the engine in this process and its children."""
    workers = WorkerPool(
        _make_runner(settings),
        workers=settings.workers,
        queue=settings.queue,
        share=settings.caller_share,
        seconds=settings.request_seconds,
        roads=roads,
        on_front=metrics.planned,
        on_failed=ending.fail,
    )
    store = SqliteStore(
        settings.store,
        entries=settings.store_entries,
        max_age=settings.store_seconds,
        max_bytes=settings.store_bytes,
    )
    ending.back_up = store.back_up
    return store, LocalEngine(workers, store)


def _redis_engine(settings: Settings, metrics: Metrics) -> tuple[Store, Engine]:
    """Return the store and the engine of a cluster."""
    redis_url = _redis_url(settings)
    from service.cluster.redis_engine import connect
    from service.cluster.script import wait_for_redis

    wait_for_redis(redis_url)
    return connect(
        redis_url,
        entries=settings.store_entries,
        max_age=settings.store_seconds,
        max_bytes=settings.store_bytes,
        queue=settings.queue,
        share=settings.caller_share,
        seconds=settings.request_seconds,
        on_front=metrics.planned,
    )


def _make_runner(settings: Settings) -> MakeRunner:
    make = partial(
        make_runner,
        settings.actors,
        settings.threads,
        settings.limits,
        settings.own_actors,
        settings.extensions,
    )
    return partial(logged, make)


def _redis_url(settings: Settings) -> str:
    if settings.redis_url is None:
        raise ValueError("PARETOUR_REDIS_URL must say for which Redis to work")
    check_cluster()
    return settings.redis_url


def _checked_actors(settings: Settings) -> Mapping[str, ActorInfo]:
    """Return the metadata of the actors by name, after a check that the operator's own ones load.

    They are loaded in another process: with ONNX Runtime this one would take 20 MB more, and
    could not be forked.

    Raises:
        ValueError: A file is not an actor, ONNX Runtime cannot run its network, or an extension is
            not installed or cannot be imported.
    """
    files = read_actor_infos(settings.actors, settings.own_actors)
    infos = {info.name: info for info in files.values()}
    constructors = constructor_infos(settings.constructors, infos)
    if settings.extensions != NO_EXTENSIONS or any(path.parent != RELEASED for path in files):
        context = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(1, mp_context=context) as pool:
            pool.submit(_load_own_code, settings).result()
    return {**infos, **constructors}


def _load_own_code(settings: Settings) -> None:
    from service.actor import load_actors
    from service.extensions.searches import load_search  # which imports compiled code

    load_actors(settings.actors, settings.threads, settings.own_actors)
    load_constructors(settings.constructors)
    load_search(settings.search)
