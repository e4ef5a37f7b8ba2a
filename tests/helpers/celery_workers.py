"""Workers of a cluster, each a process forked from the test's fork server.

Keep the imports few: each of these processes repeats them.
"""

import multiprocessing
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import forkserver
from multiprocessing.process import BaseProcess

from service.cluster.celery_app import make_celery
from service.cluster.worker import CeleryWorker, RecordWorker
from service.jobs.task_runner import TaskRunner
from service.jobs.workers import fork_server
from service.roads.client import RoadClient
from service.roads.router import RouterSettings


@contextmanager
def celery_worker(
    url: str,
    make_runner: Callable[[], TaskRunner],
    seconds: float,
    workers: int,
    roads: RouterSettings | None = None,
) -> Iterator[BaseProcess]:
    """A worker of the cluster with a number of processes."""
    fork_server.start()
    address = forkserver._forkserver._forkserver_address
    context = multiprocessing.get_context("forkserver")
    worker = context.Process(
        target=_work, args=(address, url, make_runner, seconds, workers, roads)
    )
    worker.start()
    try:
        yield worker
    finally:
        worker.kill()
        worker.join()


def _work(
    address: str,
    url: str,
    make_runner: Callable[[], TaskRunner],
    seconds: float,
    workers: int,
    roads: RouterSettings | None,
) -> None:
    _share_fork_server(address)
    worker = CeleryWorker(
        celery=make_celery(url, seconds),
        records=RecordWorker(
            make_runner,
            url,
            workers=workers,
            seconds=seconds,
            roads=roads and RoadClient(roads),
        ),
        drain_seconds=5,
    )
    worker.start()
    worker.run()


def _share_fork_server(address: str) -> None:
    """Let the fork server that this process is from fork its processes too.

    Python would start another one, which takes seconds. The command `paretour work` starts its own.
    """
    forkserver._forkserver._forkserver_address = address
    forkserver._forkserver.ensure_running = forkserver.ensure_running = lambda: None
