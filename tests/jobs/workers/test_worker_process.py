"""The end of worker processes with that of the service, and of a task that was stopped early."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from socket import socketpair
from threading import Event, Thread

import pytest

from service.jobs.workers.worker_process import _WorkerLoop
from service.kinds.front_document import FrontDocument

ROOT = Path(__file__).parents[3]

ORPHANS = """
import asyncio
from tests.helpers.scripted_runner import task, worker_pool

async def main():
    async with worker_pool(workers=2) as workers:
        submissions = [workers.submit(task("hang")) for _ in range(2)]
        while workers.working < 2:
            await asyncio.sleep(0.01)
        print(*workers.pids, flush=True)
        await asyncio.sleep(600)

if __name__ == "__main__":
    asyncio.run(main())
"""


def test_no_worker_outlives_a_service_that_is_killed(tmp_path: Path) -> None:
    script = tmp_path / "orphans.py"
    script.write_text(ORPHANS)
    command = [sys.executable, script]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE) as service:
        assert service.stdout is not None
        pids = [int(pid) for pid in service.stdout.readline().split()]
        assert len(pids) == 2
        service.kill()
        # Which ends when the last process that could write to it has ended.
        assert service.stdout.read() == b""
    assert not any(Path(f"/proc/{pid}").exists() and not zombie(pid) for pid in pids)


START = """
import asyncio
from service.jobs.workers.worker_process import WorkerProcess

async def main():
    process = await WorkerProcess.start(dict)
    process.kill()
    await process.join()

if __name__ == "__main__":
    asyncio.run(main())
"""


@pytest.mark.parametrize("length", [75, 76, 200])
def test_a_process_starts_however_long_the_path_of_the_temporary_folder_is(
    tmp_path: Path, length: int
) -> None:
    script = tmp_path / "start.py"
    script.write_text(START)
    with tempfile.TemporaryDirectory(dir="/tmp") as short:
        folder = Path(short) / ("f" * (length - len(short) - 1))
        folder.mkdir()
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "TMPDIR": str(folder)}
        subprocess.run([sys.executable, script], env=environment, check=True, timeout=600)


def zombie(pid: int) -> bool:
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"


class TerminatedRunner:
    """A runner that notes that its call is terminated."""

    def __init__(self) -> None:
        self.terminated = Event()

    def warm_up(self, *_: object) -> None:
        pass

    def run(self, *_: object) -> FrontDocument:
        raise AssertionError("no task is sent to it")

    def terminate(self) -> None:
        self.terminated.set()


def test_a_task_that_is_stopped_before_it_has_come_is_terminated_when_it_begins() -> None:
    tasks, signals = socketpair(), socketpair()
    try:
        runner = TerminatedRunner()
        loop = _WorkerLoop(tasks[0], signals[0], runner)
        Thread(target=loop._terminate_stopped, daemon=True).start()
        loop._stop(3)
        loop._set_running(2)
        assert not runner.terminated.wait(0.1)
        loop._set_running(3)
        assert runner.terminated.wait(5)
        loop._set_running(None)
    finally:
        for connection in (*tasks, *signals):
            connection.close()
