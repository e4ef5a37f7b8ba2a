"""Watching a job of the local engine: its end is seen, whenever it comes."""

import asyncio
from dataclasses import replace

import pytest

from service.errors import NotFound, StoreUnavailable
from service.jobs.deadline import Deadline
from service.jobs.local_engine import LocalEngine, UnsavedRecords
from service.jobs.record import Record, as_finished
from service.jobs.submission import Submission
from service.jobs.workers.worker_pool import WorkerPool
from service.kinds.front_document import FrontDocument
from service.requests.task_codec import encode_task
from tests.helpers.actors import Shuffler
from tests.helpers.scripted_runner import document, task

FRONT = FrontDocument(
    kind="front",
    cities=3,
    points=0,
    hypervolume=0.0,
    hypervolume_bound=None,
    reference_point=None,
    scale=None,
    timings_ms={},
    terminated=None,
    actor={},
)


class NoProcesses(WorkerPool):
    """Workers without processes: the test does the work."""

    def __init__(self) -> None:
        super().__init__(Shuffler, workers=1, queue=2)  # type: ignore[arg-type]
        self.submissions: list[Submission] = []

    async def start(self) -> None:
        pass

    def queue(self, submission: Submission) -> None:
        self.given = submission
        self.submissions.append(submission)
        super().queue(submission)

    def check_ready(self) -> None:
        self.check_open()


class Immediate:
    """A store whose answer waits for no other thread. It may be full, or admit nothing."""

    def __init__(self) -> None:
        self.records: dict[str, Record] = {}
        self.full = False

    async def put(self, record: Record) -> None:
        if self.full:
            raise OSError("database or disk is full")
        self.records[record.id] = record

    async def admit(self, record: Record) -> Record:
        await self.put(record)
        return record

    async def repeated(self, record: Record) -> Record | None:
        del record
        return None

    async def get(self, caller: str, id: str) -> Record:
        for record in self.records.values():
            if (record.caller, record.id) == (caller, id):
                return record
        raise NotFound

    async def unfinished(self) -> list[Record]:
        return [record for record in self.records.values() if not record.finished]


def new_record(id_: str = "0" * 32) -> Record:
    return Record(
        id=id_,
        caller="me",
        request_id="",
        status="queued",
        front=FRONT,
        task=encode_task(task()),
    )


async def followed(steps: int) -> list[str]:
    """The statuses that a follower sees who begins some steps of the loop after the end began."""
    workers = NoProcesses()
    jobs = LocalEngine(workers, Immediate())
    record = new_record()
    await jobs.submit(record, task())
    await asyncio.sleep(0)  # so that the job waits for its front
    workers.given.finish(FRONT)
    for _ in range(steps):
        await asyncio.sleep(0)
    following = asyncio.ensure_future(_statuses(jobs, record))
    async with asyncio.timeout(60):
        return await following


async def _statuses(jobs: LocalEngine, record: Record) -> list[str]:
    return [state.record.status async for state in jobs.watch(record)]


@pytest.mark.parametrize("steps", range(12))
def test_the_end_is_told_whenever_it_comes(steps: int) -> None:
    assert asyncio.run(followed(steps))[-1] == "done"


async def full_store() -> None:
    """The store is full as a job ends, and after a while it is not."""
    workers, store = NoProcesses(), Immediate()
    engine = LocalEngine(workers, store)
    first, second = new_record(), new_record("1" * 32)
    await engine.submit(first, task())
    following = asyncio.ensure_future(_statuses(engine, first))
    running = asyncio.ensure_future(
        engine.run(second, task(), asyncio.Future(), Deadline.after(60))
    )
    await asyncio.sleep(0)
    alone = workers.given
    store.full = True
    for submission in list(workers.submissions):
        submission.finish(FRONT)
    async with asyncio.timeout(60):
        assert (await following)[-1] == "done"
        assert (await running).status == "done"
    assert alone.ended
    assert engine.state(await store.get("me", first.id)).record.status == "done"
    for refused in (
        engine.check_ready(),
        engine.check_place("me"),
        engine.submit(new_record("2" * 32), task()),
        engine.run(new_record("3" * 32), task(), asyncio.Future(), Deadline.after(60)),
    ):
        with pytest.raises(StoreUnavailable):
            await refused
    store.full = False
    async with asyncio.timeout(60):
        while store.records[first.id].status != "done" or second.id not in store.records:
            await asyncio.sleep(0.01)
        await asyncio.sleep(0.01)
    await engine.check_ready()
    assert await _statuses(engine, first) == ["done"]
    await engine.submit(new_record("4" * 32), task())


def test_who_follows_a_job_that_cannot_be_stored_is_told_and_it_is_stored_later() -> None:
    asyncio.run(full_store())


def test_a_record_that_the_store_never_takes_gives_up_its_front() -> None:
    class Picky(Immediate):
        async def put(self, record: Record) -> None:
            if record.front.tours:
                raise ValueError("too long")
            await super().put(record)

    async def test() -> None:
        store = Picky()
        unsaved = UnsavedRecords(store, patience=0.1)  # type: ignore[arg-type]
        found = as_finished(new_record(), document("converged"), None)
        await unsaved.save(found, ValueError("too long"))
        unsaved.check_none()
        stored = store.records[found.id]
        assert stored.status == "failed"
        assert (stored.problem or {})["code"] == "store-unavailable"

    asyncio.run(test())


def test_a_job_that_cannot_be_resumed_ends() -> None:
    async def test() -> None:
        store = Immediate()
        await store.put(replace(new_record(), task=None))
        engine = LocalEngine(NoProcesses(), store)
        following = replace(new_record(), task=None)
        await engine.start()
        async with asyncio.timeout(60):
            assert (await _statuses(engine, following))[-1] == "failed"
        await engine.close()

    asyncio.run(test())


def test_a_job_may_be_cancelled_before_it_is_resumed() -> None:
    async def test() -> None:
        store = Immediate()
        await store.put(new_record())
        engine = LocalEngine(NoProcesses(), store)
        await engine.start()
        async with asyncio.timeout(60):
            assert (await engine.cancel(new_record())).status == "cancelled"
        assert store.records["0" * 32].status == "cancelled"
        await engine.close()

    asyncio.run(test())
