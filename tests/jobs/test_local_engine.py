"""Watching a job of the local engine: its end is seen, whenever it comes."""

import asyncio
from collections.abc import Callable

import pytest

from service.errors import NotFound
from service.jobs.front_document import FrontDocument, Timings
from service.jobs.local_engine import LocalEngine
from service.jobs.record import Record
from service.jobs.submission import Submission
from service.jobs.worker_pool import WorkerPool
from service.requests.task import TaskSource
from tests.helpers.actors import Shuffler

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


class NoProcesses(WorkerPool):
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


class Immediate:
    """A store of one record, whose answer waits for no other thread."""

    def __init__(self) -> None:
        self._records: list[Record] = []

    async def put(self, record: Record) -> None:
        self._records = [record]

    async def get(self, caller: str, id: str) -> Record:  # noqa: A002
        for record in self._records:
            if (record.caller, record.id) == (caller, id):
                return record
        raise NotFound


async def followed(steps: int) -> list[str]:
    """The statuses that are told to who begins to follow so many steps of the loop into the end."""
    workers = NoProcesses()
    jobs = LocalEngine(workers, Immediate())
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
        return await following


async def _statuses(jobs: LocalEngine, record: Record) -> list[str]:
    return [state.record.status async for state in jobs.watch(record)]


@pytest.mark.parametrize("steps", range(12))
def test_the_end_is_told_whenever_it_comes(steps: int) -> None:
    assert asyncio.run(followed(steps))[-1] == "done"
