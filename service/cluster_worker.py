"""A worker of the cluster, put together as the settings ask."""

import logging.config
import multiprocessing
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

from service.actor import load_actors
from service.cluster import check_cluster
from service.jobs.runner import load_planner, warm_up
from service.settings import Settings
from service.telemetry import logging_config


def build_work(settings: Settings) -> Callable[[], int]:
    """What works until told to end, and says with which status.

    Raises:
        ValueError: there is no Redis to work for, or what it takes is not installed.
    """
    redis_url = _redis_url(settings)
    from service.cluster.celery_app import queue_at
    from service.cluster.hand import make_hand
    from service.cluster.worker import Crew

    _check_actors(settings.actors, settings.threads)
    logging.config.dictConfig(logging_config())
    load = partial(load_planner, settings.actors, settings.threads, settings.limits)
    crew = Crew(
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
    from service.cluster import alive

    return alive.takes_work(redis_url)


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
