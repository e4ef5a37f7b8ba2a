"""Everything put together as the settings ask, and served."""

import gc
import signal
import sys
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from types import FrameType
from typing import NoReturn

import uvicorn
from fastapi import FastAPI

from service.actor import load_actors
from service.api.app import create_app
from service.api.auth import Access, Rates
from service.api.edge import Edge
from service.api.metrics import Metrics
from service.cluster import check_cluster
from service.jobs.engine import Engine
from service.jobs.local_engine import Jobs
from service.jobs.runner import load_planner
from service.jobs.sqlite_store import SqliteStore
from service.jobs.store import Store
from service.jobs.worker_pool import Workers
from service.settings import Settings
from service.telemetry import logging_config
from service.tracing import trace


def build(settings: Settings) -> FastAPI:
    """The application that the settings ask for."""
    # Loaded here only to know, before anything is served, that they can be and who they are.
    actors = load_actors(settings.actors, settings.threads)
    metrics = Metrics()
    store, engine = (_embedded if settings.redis_url is None else _shared)(settings, metrics)
    metrics.watch(engine)
    app = create_app(
        {name: actor.facts for name, actor in actors.items()},
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
    workers = Workers(
        partial(load_planner, settings.actors, settings.threads, settings.limits),
        workers=settings.workers,
        queue=settings.queue,
        seconds=settings.request_seconds,
        planned=metrics.planned,
    )
    store = SqliteStore(
        settings.store, entries=settings.store_entries, max_age=settings.store_seconds
    )
    return store, Jobs(workers, store)


def _shared(settings: Settings, metrics: Metrics) -> tuple[Store, Engine]:
    """The engine that many machines are together."""
    check_cluster()
    from service.cluster.replica import replica

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
