"""The service, or a worker of a cluster, put together as the settings say."""

import gc
import logging.config
import multiprocessing
import signal
import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import FrameType
from typing import NoReturn

import uvicorn
from fastapi import FastAPI

from service.actor import load_actors
from service.api.app import Edge, create_app
from service.api.auth import Access, Rates
from service.api.metrics import Metrics
from service.cluster import check_cluster
from service.jobs.engine import Engine
from service.jobs.local_engine import LocalEngine
from service.jobs.runner import load_planner, warm_up
from service.jobs.sqlite_store import SqliteStore
from service.jobs.store import Store
from service.jobs.worker_pool import WorkerPool
from service.settings import Settings
from service.telemetry import logging_config, trace


def build(settings: Settings) -> FastAPI:
    """The application that the settings ask for."""
    # Loaded here only to know, before anything is served, that they can be and who they are.
    actors = load_actors(settings.actors, settings.threads)
    metrics = Metrics()
    store, engine = (_embedded if settings.redis_url is None else _shared)(settings, metrics)
    metrics.watch(engine)
    app = create_app(
        {name: actor.info for name, actor in actors.items()},
        store,
        engine,
        settings.limits,
        _version(),
        Edge(
            access=Access(settings.api_keys, Rates(settings.rate, settings.redis_url)),
            metrics=metrics,
            origins=settings.origins,
            body_seconds=settings.body_seconds,
        ),
    )
    if settings.traces:
        trace(app)
    return app


def _embedded(settings: Settings, metrics: Metrics) -> tuple[Store, Engine]:
    """The engine in this process and its children."""
    workers = WorkerPool(
        partial(load_planner, settings.actors, settings.threads, settings.limits),
        workers=settings.workers,
        queue=settings.queue,
        seconds=settings.request_seconds,
        planned=metrics.planned,
    )
    store = SqliteStore(
        settings.store, entries=settings.store_entries, max_age=settings.store_seconds
    )
    return store, LocalEngine(workers, store)


def _shared(settings: Settings, metrics: Metrics) -> tuple[Store, Engine]:
    """The engine that many machines are together."""
    check_cluster()
    from service.cluster.redis_engine import replica

    assert settings.redis_url is not None
    return replica(
        settings.redis_url,
        entries=settings.store_entries,
        max_age=settings.store_seconds,
        queue=settings.queue,
        seconds=settings.request_seconds,
        planned=metrics.planned,
    )


def serve(app: FastAPI, settings: Settings) -> None:
    """Answer requests until told to stop."""
    # Without a handler, uvicorn ends by the signal and the exit status says so.
    signal.signal(signal.SIGTERM, _exit)
    # What is loaded stays. To look through it for garbage takes 40 ms, in which nobody is answered.
    gc.collect()
    gc.freeze()
    uvicorn.run(
        app,
        host=settings.host,
        port=settings.port,
        # Not uvloop, where it is there: 1 % more answers, and no end while Redis is connected.
        loop="asyncio",
        server_header=False,
        log_config=logging_config(),
        access_log=False,
        timeout_graceful_shutdown=settings.drain_seconds,
    )


def _version() -> str:
    try:
        return version("paretour")
    except PackageNotFoundError:
        return "not installed"


def _exit(_signal: int, _frame: FrameType | None) -> NoReturn:
    sys.exit(0)


def build_work(settings: Settings) -> Callable[[], int]:
    """What works until told to end, and says with which status.

    Raises:
        ValueError: there is no Redis to work for, or what it takes is not installed.
    """
    redis_url = _redis_url(settings)
    from service.cluster.celery_app import queue_at
    from service.cluster.worker import CeleryWorker, make_hand

    _check_actors(settings.actors, settings.threads)
    logging.config.dictConfig(logging_config())
    load = partial(load_planner, settings.actors, settings.threads, settings.limits)
    crew = CeleryWorker(
        queue=queue_at(redis_url, settings.request_seconds),
        make_hand=partial(make_hand, load, redis_url, settings.request_seconds),
        workers=settings.workers,
        drain_seconds=settings.drain_seconds,
    )

    def work() -> int:
        # Before the first fork, so that a process that takes the place of one lost has it at once.
        warm_up()
        return crew.run()

    return work


def takes_work(settings: Settings) -> bool:
    """Whether what works on this machine takes what there is to do.

    Raises:
        ValueError: there is no Redis to work for, or what it takes is not installed.
    """
    redis_url = _redis_url(settings)
    from service.cluster import worker_store

    return worker_store.takes_work(redis_url)


def _redis_url(settings: Settings) -> str:
    if settings.redis_url is None:
        raise ValueError("PARETOUR_REDIS_URL must say for which Redis to work")
    check_cluster()
    return settings.redis_url


def _check_actors(directory: Path, threads: int) -> None:
    """Load the networks, elsewhere: a process that will fork must not have them."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context) as elsewhere:
        elsewhere.submit(_load_actors, directory, threads).result()


def _load_actors(directory: Path, threads: int) -> None:
    load_actors(directory, threads)
