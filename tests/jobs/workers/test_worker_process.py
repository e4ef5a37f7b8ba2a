"""The end of worker processes with that of the service."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[3]

ORPHANS = """
import asyncio
from tests.helpers.scripted_runner import source, worker_pool

async def main():
    async with worker_pool(workers=2) as workers:
        submissions = [workers.submit(source(b"hang")) for _ in range(2)]
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


def zombie(pid: int) -> bool:
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
