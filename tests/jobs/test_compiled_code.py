"""What a request needs is compiled when a worker says that it is warm, and loaded by the next."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

PLANS = """
import json, sys
from pathlib import Path
import service
from service.jobs.compiled_code import load_from_cache
from service.jobs.task_runner import load_runner
from service.requests.parser import parse_task
from service.requests.task import TaskSource
from service.settings import Settings

def compiled():
    modules = [module for name, module in list(sys.modules.items()) if name.startswith("service.")]
    kernels = {id(each): each for module in modules for each in vars(module).values()}
    kernels = [each for each in kernels.values() if hasattr(each, "overloads")]
    return {f"{each.__module__}.{each.__name__}": len(each.overloads) for each in kernels}

settings = Settings()
runner = load_runner(settings.actors, 1, settings.limits)
load_from_cache()
before = compiled()
for path in sorted((Path(service.__file__).parent / "examples").glob("*.json")):
    request = json.loads(path.read_text())
    if "time_limit" not in request:  # the index, and streets
        continue
    kind = "coverage" if "grid" in request else "fleet" if "vehicles" in request else "front"
    for seconds in (0, 0.2):
        source = TaskSource(kind, json.dumps({**request, "time_limit": seconds}).encode(), None)
        runner.run(parse_task(source, runner.limits, runner.infos), lambda: False, lambda *_: None)
cities = [[x % 97, x % 89, x % 83, x % 79] for x in range(700)]
for closed in (True, False):
    request = {"coordinates": cities, "closed": closed, "time_limit": 0.2}
    source = TaskSource("front", json.dumps(request).encode(), None)
    runner.run(parse_task(source, runner.limits, runner.infos), lambda: False, lambda *_: None)
after = compiled()
print(json.dumps({name: number for name, number in after.items() if number > before.get(name, 0)}))
"""


@pytest.mark.usefixtures("compiled")
def test_the_examples_and_many_cities_need_nothing_that_is_not_compiled() -> None:
    command = [sys.executable, "-c", PLANS]
    ran = subprocess.run(command, capture_output=True, check=True, cwd=Path(__file__).parents[2])
    assert json.loads(ran.stdout) == {}


def test_what_is_not_in_the_cache_is_not_compiled_by_loading_it(tmp_path: Path) -> None:
    load = "from service.jobs.compiled_code import load_from_cache; load_from_cache()"
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    subprocess.run([sys.executable, "-c", load], check=True, env=environment)
    assert not list(tmp_path.rglob("*.nbc"))


def test_a_process_that_compiles_ends_with_the_one_that_needs_it(tmp_path: Path) -> None:
    queue, end_of_queue = os.pipe()
    os.write(end_of_queue, bytes([0]))
    command = [sys.executable, "-m", "service.jobs.compiled_code", str(queue)]
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
