"""Worker processes: what becomes of work, and of them, whatever happens."""

import asyncio
import os
import resource
import signal
from collections.abc import Awaitable, Callable
from contextlib import nullcontext, suppress
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from service.errors import (
    Cancelled,
    DeadlineExceeded,
    NoWorker,
    QueueFull,
    ShareFull,
    ShuttingDown,
    WarmingUp,
    WorkerLost,
)
from service.jobs.deadline import Deadline
from service.jobs.workers.worker_pool import WorkerPool
from service.jobs.workers.worker_process import Runner
from service.kinds.front_document import FrontDocument
from service.kinds.parts import Compiling
from tests.helpers.scripted_runner import ScriptedRunner, brief_task, task, worker_pool


def run(test: Callable[[WorkerPool], Awaitable[None]], *args: Any, **options: Any) -> None:
    """A test with workers at work."""

    async def with_workers() -> None:
        async with worker_pool(*args, **options) as workers:
            await asyncio.wait_for(test(workers), timeout=60)

    asyncio.run(with_workers())


async def until(holds: Callable[[], bool]) -> None:
    while not holds():
        await asyncio.sleep(0.005)


async def front(workers: WorkerPool, deed: str = "") -> FrontDocument:
    return await workers.submit(task(deed)).front()


def test_work_becomes_a_front_with_the_time_that_it_waited() -> None:
    async def test(workers: WorkerPool) -> None:
        timings = (await front(workers)).timings_ms
        assert timings["construction"] == 1
        assert timings["total"] == pytest.approx(timings["queue"] + 1)

    run(test)


def test_what_fails_fails_for_whoever_asked_with_the_traceback_of_the_worker() -> None:
    async def test(workers: WorkerPool) -> None:
        with pytest.raises(KeyError, match="city") as failed:
            await front(workers, "fail")
        assert 'raise KeyError("city")' in failed.value.__notes__[0]
        assert (await front(workers)).terminated == "converged"

    run(test)


def test_work_keeps_its_place_when_nobody_waits_for_it_any_more() -> None:
    async def test(workers: WorkerPool) -> None:
        submission = workers.submit(task("wait"))
        await until(lambda: workers.working == 1)
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(submission.front(), timeout=0.05)
        with pytest.raises(QueueFull):
            workers.submit(task())
        workers.stop(submission)
        assert (await submission.front()).terminated == "cancelled"

    run(test)


def test_work_that_is_stopped_while_it_waits_gives_up_its_place() -> None:
    async def test(workers: WorkerPool) -> None:
        workers.submit(task("wait"))
        waiting = workers.submit(task())
        workers.stop(waiting)
        with pytest.raises(Cancelled):
            await waiting.front()
        workers.submit(task())

    run(test, queue=1)


def test_work_that_does_not_listen_is_ended_and_its_process_replaced() -> None:
    async def test(workers: WorkerPool) -> None:
        submission = workers.submit(task("hang"))
        await until(lambda: workers.working == 1)
        workers.stop(submission)
        with pytest.raises(Cancelled):
            await submission.front()
        assert workers.lost == 0
        assert (await front(workers)).terminated == "converged"
        assert workers.lost == 1

    run(test, stop_seconds=1.0)


@pytest.mark.parametrize("deed", ["wait", "stop slowly", "call"])
def test_to_stop_work_ends_no_process(deed: str) -> None:
    async def test(workers: WorkerPool) -> None:
        await front(workers)
        before = list(workers.pids)
        for _ in range(3):
            submission = workers.submit(task(deed))
            await until(lambda: workers.working == 1)
            workers.stop(submission)
            with suppress(Cancelled):
                await submission.front()
            assert workers.working == 0
        assert (await front(workers)).terminated == "converged"
        assert (workers.pids, workers.lost) == (before, 0)

    run(test)


def test_a_process_takes_no_work_until_what_was_stopped_has_ended() -> None:
    async def test(workers: WorkerPool) -> None:
        submission = workers.submit(task("stop slowly"))
        await until(lambda: workers.working == 1)
        workers.stop(submission)
        with pytest.raises(Cancelled):
            await submission.front()
        following = workers.submit(task())
        assert (workers.working, workers.waiting) == (0, 1)
        assert (await following.front()).terminated == "converged"

    run(test)


def test_clients_take_turns_and_none_holds_more_than_its_share() -> None:
    async def test(workers: WorkerPool) -> None:
        begun: list[str] = []
        first = workers.submit(task("wait"), client="many")
        submissions = []
        for name, client in (("m1", "many"), ("m2", "many"), ("o1", "one"), ("m3", "many")):
            began = partial(begun.append, name)
            submissions.append(workers.submit(task(), began, client=client))
        with pytest.raises(ShareFull) as refused:
            workers.check_place("many")
        assert refused.value.limit == 4
        workers.check_place("one")
        workers.stop(first)
        for submission in submissions:
            await submission.front()
        assert begun == ["m1", "o1", "m2", "m3"]
        workers.check_place("many")

    run(test, queue=7, share=0.5)


def test_a_client_that_is_served_waits_behind_those_that_are_not() -> None:
    async def test(workers: WorkerPool) -> None:
        begun: list[str] = []
        served, other = (workers.submit(task("wait"), client=name) for name in ("many", "other"))
        submissions = []
        for name, client in (("m1", "many"), ("m2", "many"), ("o1", "one"), ("t1", "two")):
            began = partial(begun.append, name)
            submissions.append(workers.submit(task(), began, client=client))
        await until(lambda: len(workers.running) == 2)
        workers.stop(other)
        for submission in submissions:
            await submission.front()
        assert begun == ["o1", "t1", "m1", "m2"]
        workers.stop(served)

    run(test, workers=2, queue=7)


def test_brief_work_that_waits_shares_a_turn_of_a_process() -> None:
    async def test(workers: WorkerPool) -> None:
        together: list[int] = []

        def began() -> None:
            together.append(len(workers.running))
            assert workers.working == 1

        first = workers.submit(task("wait"))
        await until(lambda: len(workers.running) == 1)
        waiting = [*[brief_task()] * 6, task(), brief_task()]
        submissions = [workers.submit(each, began) for each in waiting]
        workers.stop(first)
        for submission in submissions:
            assert (await submission.front()).terminated == "converged"
        assert together == [4, 4, 4, 4, 2, 2, 1, 1]

    run(test, queue=8)


def test_two_processes_share_the_brief_work_that_waits() -> None:
    async def test(workers: WorkerPool) -> None:
        first = [workers.submit(task("wait")) for _ in range(2)]
        await until(lambda: len(workers.running) == 2)
        submissions = [workers.submit(brief_task("wait")) for _ in range(4)]
        workers.stop(first[0])
        await until(lambda: first[0] not in workers.running)
        assert [each in workers.running for each in submissions] == [True, True, False, False]
        for submission in (*first, *submissions):
            workers.stop(submission)

    run(test, workers=2, queue=4)


def test_brief_work_that_shares_a_turn_is_stopped_alone() -> None:
    async def test(workers: WorkerPool) -> None:
        first = workers.submit(task("wait"))
        await until(lambda: len(workers.running) == 1)
        submissions = [workers.submit(brief_task(body)) for body in ("wait", "wait", "")]
        workers.stop(first)
        await until(lambda: len(workers.running) == 3)
        waiting, stopped, other = submissions
        workers.stop(stopped)
        with pytest.raises(Cancelled):
            await stopped.front()
        assert not waiting.ended
        workers.stop(waiting)
        assert (await waiting.front()).terminated == "cancelled"
        assert (await other.front()).terminated == "converged"
        assert workers.lost == 0

    run(test, queue=3)


@pytest.mark.parametrize("deaths", [1, 2])
def test_brief_work_beside_what_kills_its_process_is_done(tmp_path: Path, deaths: int) -> None:
    lives = tmp_path / "lives"
    lives.write_bytes(bytes(deaths))

    async def test(workers: WorkerPool) -> None:
        first = workers.submit(task("wait"))
        await until(lambda: len(workers.running) == 1)
        submissions = [workers.submit(brief_task(body)) for body in ("", "die", "")]
        workers.stop(first)
        before, deadly, behind = submissions
        assert (await before.front()).terminated == "converged"
        assert (await behind.front()).terminated == "converged"
        assert workers.lost == deaths
        with pytest.raises(WorkerLost) if deaths > 1 else nullcontext():
            await deadly.front()

    run(test, ScriptedRunner(lives=lives), queue=3)


def test_processes_that_cannot_be_started_are_tried_again(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def test(workers: WorkerPool) -> None:
        await front(workers)
        await until(lambda: is_ready(workers))
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (0, hard))
        try:
            for pid in workers.pids:
                os.kill(pid or 0, signal.SIGKILL)
            await until(lambda: not workers.pids)
            await asyncio.sleep(2)
            with pytest.raises(NoWorker):
                workers.check_ready()
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
        assert (await front(workers)).terminated == "converged"
        await until(lambda: is_ready(workers) and len(workers.pids) == 2)
        assert sum("cannot run" in record.message for record in caplog.records) == 1

    run(test, workers=2)


def never_made() -> Runner:
    raise ValueError("no network is there")


def test_processes_that_never_load_are_told_with_the_cause_after_three_tries() -> None:
    async def test() -> None:
        reasons: list[str] = []
        pool = WorkerPool(never_made, workers=1, queue=1, on_failed=reasons.append)
        await pool.start()
        try:
            await until(lambda: bool(reasons))
            with pytest.raises(NoWorker, match="no network is there"):
                pool.check_ready()
        finally:
            await pool.close()
        assert len(reasons) == 1
        assert "no network is there" in reasons[0]

    asyncio.run(test())


def is_ready(workers: WorkerPool) -> bool:
    with suppress(WarmingUp, NoWorker):
        workers.check_ready()
        return True
    return False


@pytest.mark.parametrize("seconds", [2.0, None])
def test_work_that_takes_too_long_ends_with_the_best_front_so_far(seconds: float | None) -> None:
    async def test(workers: WorkerPool) -> None:
        await workers.submit(task()).front()
        told: list[None] = []
        deadline = None if seconds is None else Deadline.after(seconds)
        submission = workers.submit(task("report and hang"), lambda: told.append(None), deadline)
        found = await submission.front()
        assert (found.terminated, found.points) == ("time_limit", 1)
        # That it was begun, and what was found.
        assert len(told) > 1

    run(test, seconds=2.0 if seconds is None else 600.0)


def test_work_whose_deadline_is_over_while_it_waits_fails() -> None:
    async def test(workers: WorkerPool) -> None:
        running = workers.submit(task("wait"))
        await until(lambda: workers.working == 1)
        with pytest.raises(DeadlineExceeded):
            await workers.submit(task(), deadline=Deadline.after(0)).front()
        assert workers.waiting == 0
        workers.stop(running)

    run(test, queue=1)


def test_work_that_takes_too_long_and_found_nothing_fails() -> None:
    async def test(workers: WorkerPool) -> None:
        with pytest.raises(DeadlineExceeded):
            await front(workers, "hang")

    run(test, seconds=1.0)


def test_work_whose_process_is_killed_is_done_by_another(tmp_path: Path) -> None:
    lives = tmp_path / "lives"
    lives.write_bytes(b"1")

    async def test(workers: WorkerPool) -> None:
        assert (await front(workers, "die")).terminated == "converged"
        assert workers.lost == 1

    run(test, ScriptedRunner(lives=lives))


def test_work_that_kills_two_processes_is_given_up_and_others_are_done(tmp_path: Path) -> None:
    lives = tmp_path / "lives"
    lives.write_bytes(b"123")

    async def test(workers: WorkerPool) -> None:
        deadly, other = workers.submit(task("die")), workers.submit(task())
        with pytest.raises(WorkerLost):
            await deadly.front()
        assert (await other.front()).terminated == "converged"
        assert lives.read_bytes() == b"3"

    run(test, ScriptedRunner(lives=lives), queue=1)


def test_a_process_killed_while_idle_is_replaced() -> None:
    async def test(workers: WorkerPool) -> None:
        await front(workers)
        [killed] = workers.pids
        assert killed is not None
        os.kill(killed, signal.SIGKILL)
        await until(lambda: workers.lost == 1)
        assert (await front(workers)).terminated == "converged"
        assert killed not in workers.pids

    run(test)


def test_a_process_that_has_grown_large_answers_and_is_replaced() -> None:
    async def test(workers: WorkerPool) -> None:
        await until(lambda: is_ready(workers))
        [grown] = workers.pids
        grows, following = workers.submit(task("grow")), workers.submit(task())
        assert (await grows.front()).terminated == "converged"
        assert (await following.front()).terminated == "converged"
        assert grown not in workers.pids
        assert (following.attempts, workers.lost) == (1, 0)

    run(test, queue=1)


def test_work_waits_for_its_compiled_code_and_what_needs_none_overtakes_it(
    tmp_path: Path,
) -> None:
    async def test(workers: WorkerPool) -> None:
        told: list[None] = []
        waiting = workers.submit(task(), lambda: told.append(None))
        assert (await workers.submit(brief_task()).front()).terminated == "converged"
        await until(lambda: len(told) > 1)
        assert (waiting.compiling, waiting.attempts) == (Compiling(0.5, 20.0), 0)
        with pytest.raises(WarmingUp, match="50 %, about 20 s left") as refused:
            workers.check_ready()
        assert refused.value.headers["Retry-After"] == "20"
        (tmp_path / "warm").touch()
        assert (await waiting.front()).terminated == "converged"
        assert waiting.compiling is None
        await until(lambda: workers.compiling is None)
        workers.check_ready()

    run(test, ScriptedRunner(warm=tmp_path / "warm"), workers=2, queue=2)


def test_work_whose_deadline_is_over_while_its_code_is_compiled_is_told_to_come_again(
    tmp_path: Path,
) -> None:
    async def test(workers: WorkerPool) -> None:
        await until(lambda: workers.compiling is not None)
        with pytest.raises(WarmingUp, match="about 20 s left"):
            await workers.submit(task(), deadline=Deadline.after(0.1)).front()
        assert workers.waiting == 0

    run(test, ScriptedRunner(warm=tmp_path / "warm"))


def test_all_is_compiled_where_the_process_that_began_is_lost(tmp_path: Path) -> None:
    async def test(workers: WorkerPool) -> None:
        await until(lambda: workers.compiling is not None)
        for pid in workers.pids:
            os.kill(pid or 0, signal.SIGKILL)
        (tmp_path / "warm").touch()
        assert (await front(workers)).terminated == "converged"
        await until(lambda: workers.compiling is None)

    run(test, ScriptedRunner(warm=tmp_path / "warm"), workers=2)


def test_after_the_close_no_work_is_taken_and_none_is_waited_for_in_vain() -> None:
    async def test(workers: WorkerPool) -> None:
        submissions = [workers.submit(task("hang")) for _ in range(2)]
        await until(lambda: workers.working == 1)
        await workers.close()
        for submission in submissions:
            with pytest.raises(ShuttingDown):
                await submission.front()
        with pytest.raises(ShuttingDown):
            workers.check_open()
        with pytest.raises(ShuttingDown):
            workers.submit(task())

    run(test, queue=1)
