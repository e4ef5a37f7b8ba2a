"""A worker of the cluster whose processes do not start, and one that ends."""

import asyncio
from contextlib import suppress
from typing import Any

import pytest

from service.cluster.worker import RecordWorker
from service.cluster.worker_store import WorkerStore
from service.errors import NoWorker
from service.jobs.workers.worker_process import Runner
from tests.helpers.scripted_runner import ScriptedRunner

NO_REDIS = "redis://127.0.0.1:1/0"


def never_made() -> Runner:
    raise ValueError("no network is there")


def test_a_worker_whose_processes_never_load_ends_with_the_cause() -> None:
    worker = RecordWorker(never_made, NO_REDIS, workers=1, seconds=9.0)
    with pytest.raises(NoWorker, match="no network is there"):
        asyncio.run(worker.start())


def test_a_worker_that_has_ended_sends_no_heartbeats(monkeypatch: pytest.MonkeyPatch) -> None:
    sent: list[Any] = []  # the tasks that sent one

    async def send_heartbeat(_: WorkerStore) -> None:
        sent.append(asyncio.current_task())
        with suppress(asyncio.CancelledError):  # as redis-py may miss it under Python 3.11
            await asyncio.sleep(60)

    monkeypatch.setattr(WorkerStore, "send_heartbeat", send_heartbeat)

    async def scenario() -> bool:
        worker = RecordWorker(ScriptedRunner, NO_REDIS, workers=1, seconds=9.0)
        await worker.start()
        while not sent:
            await asyncio.sleep(0.01)
        await worker.close()
        return sent[0].cancelled()

    assert asyncio.run(scenario())
