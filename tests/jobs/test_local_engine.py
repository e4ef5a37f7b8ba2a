"""Whoever follows a job hears of its end, however the two happen to fall together."""

import asyncio
from collections.abc import Callable

import pytest

from service.jobs.front_document import FrontDocument, Timings
from service.jobs.local_engine import LocalEngine
from service.jobs.record import Record
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from service.jobs.submission import Submission
from service.jobs.worker_pool import WorkerPool
from service.requests.task import TaskSource
from tests.helpers.serving import Shuffler

FRONT = FrontDocument(
    cities=3,
    points=0,
    hypervolume=0.0,
    hypervolume_bound=None,
    reference_point=None,
    scale=None,
    timings_ms=Timings({}),
    terminated=None,
    actor={},
)


class OrdersOnly(WorkerPool):
    """Workers without processes: the test does the work."""

    def __init__(self) -> None:
        super().__init__(Shuffler, workers=1, queue=1)  # type: ignore[arg-type]

    def submit(
        self,
        source: TaskSource,
        on_change: Callable[[], None] = lambda: None,
        patient: bool = False,
    ) -> Submission:
        self.given = Submission(0, source, on_change, patient)
        return self.given


class Immediate(SqliteStore):
    """A store whose answer waits for no other thread."""

    async def put(self, record: Record) -> None:
        self._in_transaction(self._put, record)


async def followed(steps: int) -> list[str]:
    """The statuses that are told to who begins to follow so many steps of the loop into the end."""
    store = Immediate(IN_MEMORY, entries=10, max_age=60)
    workers = OrdersOnly()
    jobs = LocalEngine(workers, store)
    record = Record(
        id="0" * 32,
        caller="me",
        request_id="",
        status="queued",
        front=FRONT,
        source=TaskSource("front", b""),
    )
    await jobs.submit(record)
    await asyncio.sleep(0)  # so that the job waits for its front
    workers.given.finish(FRONT)
    for _ in range(steps):
        await asyncio.sleep(0)
    following = asyncio.ensure_future(_statuses(jobs, record))
    async with asyncio.timeout(1):
        statuses = await following
    await store.close()
    return statuses


async def _statuses(jobs: LocalEngine, record: Record) -> list[str]:
    return [state.record.status async for state in jobs.watch(record)]


@pytest.mark.parametrize("steps", range(12))
def test_the_end_is_told_whenever_it_comes(steps: int) -> None:
    assert asyncio.run(followed(steps))[-1] == "done"
