"""What a request needs is compiled when a worker says that it is warm, and loaded by the next."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

from tests.helpers.processes import serve_process
from tests.helpers.processors import ANOTHER_NAME, of_the_level
from tests.helpers.sampled import at_night

PLANS = """
import json, sys
from pathlib import Path
import service
from service.jobs.compiled_code import load_from_cache
from service.kinds.table import kind_of, parts_of
from service.jobs.task_runner import load_runner
from service.kinds.parsing import parse_task
from service.requests.task import TaskSource
from service.settings import Settings

def compiled():
    modules = [module for name, module in list(sys.modules.items()) if name.startswith("service.")]
    kernels = {id(each): each for module in modules for each in vars(module).values()}
    kernels = [each for each in kernels.values() if hasattr(each, "overloads")]
    return {f"{each.__module__}.{each.__name__}": len(each.overloads) for each in kernels}

settings = Settings()
runner = load_runner(settings.actors, 1, settings.limits)

def read(kind, request):
    source = TaskSource(kind, json.dumps(request).encode(), None)
    return parse_task(source, runner.limits, runner.infos)

tasks = []
for path in sorted((Path(service.__file__).parent / "examples").glob("*.json")):
    request = json.loads(path.read_text())
    if "time_limit" not in request:  # the index, and streets
        continue
    kind = "coverage" if "grid" in request else "fleet" if "vehicles" in request else "front"
    tasks += [read(kind, {**request, "time_limit": seconds}) for seconds in (0, 0.1)]
for n in (240, 700, 1_500):
    cities = [[x % 97, x % 89, x % 83, x % 79] for x in range(n)]
    for closed in (True, False):
        tasks.append(read("front", {"coordinates": cities, "closed": closed, "time_limit": 0.1}))
for n, planes in ((9, 2), (60, 2), (9, 3), (60, 4), (700, 3)):
    primes = (97, 89, 83, 79, 73, 71, 67, 61)[:2 * planes]
    cities = [[x % prime for prime in primes] for x in range(n)]
    for bound in {False, n < 100}:
        request = {"coordinates": cities, "time_limit": 0.1, "size": 9, "bound": bound}
        tasks.append(read("front", request))
for planes in (2, 3):
    matrices = [[[x * y % m for x in range(20)] for y in range(20)] for m in (5, 7, 9)[:planes]]
    tasks.append(read("front", {"matrices": matrices, "time_limit": 0.1, "bound": True}))
loaded, lacking = set(), {}
for task in sorted(tasks, key=lambda task: len(parts_of(task))):
    for part in parts_of(task) - loaded:
        load_from_cache(part)
        loaded.add(part)
    before = compiled()
    runner.run(task, lambda: False, lambda *_: None)
    more = {name for name, number in compiled().items() if number > before.get(name, 0)}
    if more:
        lacking[f"{kind_of(task).name} of {task.subject}"[:80]] = sorted(more)
print(json.dumps(lacking))
"""


@pytest.mark.usefixtures("compiled")
def test_tasks_need_no_more_compiled_code_than_their_parts() -> None:
    command = [sys.executable, "-c", PLANS]
    ran = subprocess.run(command, capture_output=True, check=True, cwd=Path(__file__).parents[2])
    assert json.loads(ran.stdout) == {}


@of_the_level
@pytest.mark.usefixtures("compiled")
def test_a_processor_of_another_name_loads_all_that_was_compiled() -> None:
    load = """
from service.jobs.compiled_code import load_from_cache
from service.kinds.parts import Part
print(all([load_from_cache(part) for part in Part]))
"""
    command = [sys.executable, "-c", ANOTHER_NAME + load]
    assert subprocess.run(command, capture_output=True, check=True).stdout == b"True\n"


def test_what_is_not_in_the_cache_is_not_compiled_by_loading_it(tmp_path: Path) -> None:
    load = """
from service.jobs.compiled_code import load_from_cache
from service.kinds.parts import Part
assert not any([load_from_cache(part) for part in Part])
"""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    subprocess.run([sys.executable, "-c", load], check=True, env=environment)
    assert not list(tmp_path.rglob("*.nbc"))


def test_a_process_that_compiles_ends_with_the_one_that_needs_it(tmp_path: Path) -> None:
    queue, end_of_queue = os.pipe()
    os.write(end_of_queue, bytes([0]))
    command = [sys.executable, "-m", "service.jobs.compilers", str(queue), "1", "1"]
    ran = subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        pass_fds=[queue],
        check=False,
        env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
    )
    os.close(queue)
    os.close(end_of_queue)
    assert ran.returncode == 1


@at_night
def test_processes_that_compile_end_with_the_service(tmp_path: Path) -> None:
    settings = {"NUMBA_CACHE_DIR": str(tmp_path), "NUMBA_DISABLE_JIT": "0", "PARETOUR_WORKERS": "1"}
    with serve_process(settings) as service:
        while not _has_compiled_some(httpx.get(f"{service.url}/health/ready").json()):
            time.sleep(0.1)
        processes = psutil.Process(service.process.pid).children(recursive=True)
        # The fork server, Python's resource tracker, a worker, and those that compile
        assert len(processes) >= 3 + len(os.sched_getaffinity(0))
        service.process.kill()
        _, left = psutil.wait_procs(processes, timeout=30)
    assert left == []


def _has_compiled_some(ready: dict[str, Any]) -> bool:
    """Whether the service says how far it is, before or after it has opened its networks."""
    return "compiling" in ready or "%" in ready["detail"]
