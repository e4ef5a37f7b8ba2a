"""A worker of the cluster whose processes do not start."""

import asyncio

import pytest

from service.cluster.worker import RecordWorker
from service.errors import NoWorker
from service.jobs.workers.worker_process import Runner


def never_made() -> Runner:
    raise ValueError("no network is there")


def test_a_worker_whose_processes_never_load_ends_with_the_cause() -> None:
    worker = RecordWorker(never_made, "redis://127.0.0.1:1/0", workers=1, seconds=9.0)
    with pytest.raises(NoWorker, match="no network is there"):
        asyncio.run(worker.start())
