"""A service runs its own code in any folder, says why it cannot, and calls nobody unasked."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import psutil
import pytest

from tests.helpers.ports import free_port
from tests.helpers.processes import PATIENCE, until_ok
from tests.helpers.sampled import at_night

PARETOUR = str(Path(sys.executable).with_name("paretour"))
CITIES = [[float(i), float(i * i % 7), float(i * 3 % 5), float(i)] for i in range(12)]


@contextmanager
def served(folder: Path, **settings: str) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """Run the installed command in a folder, and yield its process and address.

    Its log is in the file `log` beside that folder: a pipe that nobody reads would fill up.
    """
    port = free_port()
    environment = {**os.environ, **settings}
    if "PYTHONPATH" not in settings:
        environment.pop("PYTHONPATH", None)
    command = [PARETOUR, "serve", "--port", str(port), "--workers", "1"]
    with (
        log_of(folder).open("wb") as log,
        subprocess.Popen(command, cwd=folder, env=environment, stderr=log) as process,
    ):
        try:
            yield process, f"http://127.0.0.1:{port}"
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(PATIENCE)


def log_of(folder: Path) -> Path:
    return folder.with_name(f"{folder.name}-log")


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize(  # a package hides a module of its name
    "names",
    [
        ["service/__init__.py", "numpy.py", "signal.py"],
        pytest.param(["service.py"], marks=at_night),
    ],
)
def test_a_module_in_the_current_folder_stands_in_for_none_that_is_installed(
    tmp_path: Path, quick_actors: dict[str, str], names: list[str]
) -> None:
    for name in names:
        module = tmp_path / name
        module.parent.mkdir(exist_ok=True)
        module.write_text("raise RuntimeError('not the one that is installed')")
    with served(tmp_path, **quick_actors) as (process, url):
        until_ok(f"{url}/health/ready", process, log_of(tmp_path))
        answer = httpx.post(f"{url}/front", json={"coordinates": CITIES, "time_limit": 0.1})
        assert answer.status_code == 200
        # A long body is parsed in a process of its own.
        content = answer.request.content + b" " * 2**18
        headers = {"Content-Type": "application/json"}
        answer = httpx.post(f"{url}/front", content=content, headers=headers, timeout=300)
        assert answer.status_code == 200


# Run by each Python that starts with this folder on its path: in workers one import fails.
BROKEN_WORKERS = """
import sys

class Broken:
    def find_spec(name, path=None, target=None):
        if name == "{package}":
            raise {error}("no {package}")

if any("forkserver" in argument for argument in sys.orig_argv):
    sys.meta_path.insert(0, Broken)
"""


@pytest.mark.parametrize(
    ("package", "error"),
    [
        ("onnxruntime", "ImportError"),  # which each worker imports
        ("numba", "ValueError"),  # which the process imports that forks them
    ],
)
def test_a_service_whose_workers_cannot_load_says_why_and_ends(
    package: str, error: str, tmp_path: Path
) -> None:
    code = BROKEN_WORKERS.format(package=package, error=error)
    (tmp_path / "sitecustomize.py").write_text(code, encoding="utf-8")
    with served(tmp_path, PYTHONPATH=str(tmp_path)) as (process, _):
        assert process.wait(PATIENCE) == 3
    log = log_of(tmp_path).read_bytes()
    assert f"the service cannot start: {error}('no {package}')".encode() in log


def connections(process: psutil.Process) -> set[str]:
    """The addresses, not of this machine, that a process and its children talk to."""
    found = set()
    for each in [process, *process.children(recursive=True)]:
        for connection in each.net_connections("inet"):
            if connection.raddr and connection.raddr.ip not in ("127.0.0.1", "::1"):
                found.add(f"{connection.raddr.ip}:{connection.raddr.port}")
    return found


@pytest.mark.usefixtures("compiled")
def test_a_service_writes_its_cache_alone_and_connects_to_nobody(tmp_path: Path) -> None:
    # A long path: there is no room behind it for the names of sockets.
    home, work = tmp_path / "home", tmp_path / ("work" * 20)
    home.mkdir()
    work.mkdir()
    places = {f"XDG_{kind}_HOME": str(home / kind) for kind in ("CACHE", "CONFIG", "DATA", "STATE")}
    outward = set()
    with served(work, HOME=str(home), TMPDIR=str(work), **places) as (process, url):
        until_ok(f"{url}/health/ready", process, log_of(work))
        for limit in (0, 0.2):
            body = {"coordinates": CITIES, "time_limit": limit}
            assert httpx.post(f"{url}/front", json=body).status_code == 200
            outward |= connections(psutil.Process(process.pid))
    written = {path for path in [*home.rglob("*"), *work.rglob("*")] if path.is_file()}
    assert {path for path in written if "numba" not in str(path)} == set()
    assert outward == set()


ENGINES = ("llvmlite", "numba", "onnxruntime", "scipy")
MAP = {"grid": [[0] * 4] * 3, "cell_size": 1, "places": [[0, 0], [2, 3], [1, 1]]}
FLEET = {
    "stops": [{"id": str(number)} for number in range(4)],
    "vehicles": [{"id": "van", "start": 0}],
    "objectives": [{"name": name, "matrix": [[1] * 4] * 4} for name in "ab"],
}


def engines(pid: int) -> set[str]:
    """The libraries that plan, as far as a process has them loaded."""
    loaded = Path(f"/proc/{pid}/maps").read_text()
    return {name for name in ENGINES if f"/site-packages/{name}/" in loaded}


@pytest.mark.usefixtures("compiled")
def test_the_service_and_its_parsers_load_nothing_that_plans(
    tmp_path: Path, quick_actors: dict[str, str]
) -> None:
    with served(tmp_path, **quick_actors) as (process, url):
        until_ok(f"{url}/health/ready", process, log_of(tmp_path))
        with httpx.Client(base_url=url, timeout=300) as client:
            layer, robots = {"cost_layer": [[1] * 4] * 3}, {"robots": [{"id": "r"}]}
            ids = []
            for path, body in (
                ("/front", {"coordinates": CITIES}),
                ("/coverage", {**MAP, **layer}),
                ("/coverage", {**MAP, **robots}),
                ("/fleet", FLEET),
            ):
                # A long body is parsed in a process of its own.
                for more in (0, 2**18):
                    content = json.dumps({**body, "time_limit": 0.1}).encode() + b" " * more
                    headers = {"Content-Type": "application/json"}
                    answer = client.post(path, content=content, headers=headers)
                    assert answer.status_code == 200, answer.text
                    ids.append(answer.json()["id"])
            for front, changes in zip(ids[:4], [{}] * 2 + [{"blocked": [[0, 2]]}] * 2, strict=True):
                content = json.dumps({"done": [0], "time_limit": 0.1, **changes}).encode()
                for more in (0, 2**18):
                    url_of_rest = f"/front/{front}/replan"
                    answer = client.post(
                        url_of_rest, content=content + b" " * more, headers=headers
                    )
                    assert answer.status_code == 200, answer.text
            assert client.get("/tour", params={"front": ids[0], "knee": True}).status_code == 200
        children = psutil.Process(process.pid).children()
        parsers = [child.pid for child in children if "anyio.to_process" in child.cmdline()]
        assert len(parsers) == 1
        assert [engines(pid) for pid in (process.pid, *parsers)] == [set(), set()]


def test_onnx_runtime_is_imported_in_one_place_with_its_telemetry_off() -> None:
    root = Path(__file__).parents[1]
    importing = {
        str(path.relative_to(root))
        for part in ("service", "models", "export", "tests")
        for path in (root / part).rglob("*.py")
        for line in path.read_text().splitlines()
        if line.strip().startswith(("import onnxruntime", "from onnxruntime"))
    }
    assert importing == {"service/onnx_runtime.py"}
    code = "from service.onnx_runtime import onnxruntime, os; print(os.environ)"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout
    assert b"'ORT_DISABLE_TELEMETRY': '1'" in shown
