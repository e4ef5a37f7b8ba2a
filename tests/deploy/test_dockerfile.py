"""The Dockerfile: its instructions, and its steps run as plain commands."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from tests.helpers.ports import free_port

ROOT = Path(__file__).parents[2]
DOCKERFILE = (ROOT / "Dockerfile").read_text().replace("\\\n", " ")
INSTRUCTIONS = [
    tuple(line.split(maxsplit=1)) for line in DOCKERFILE.splitlines() if re.match("[A-Z]+ ", line)
]
FINAL = INSTRUCTIONS[[name for name, _ in INSTRUCTIONS].index("FROM", 1) :]


def only(name: str) -> str:
    """Return the argument of the one instruction of this name in the final stage."""
    [argument] = [argument for each, argument in FINAL if each == name]
    return argument


def health_command() -> list[str]:
    return json.loads(only("HEALTHCHECK").partition("CMD ")[2])


def test_hadolint_finds_nothing() -> None:
    hadolint = shutil.which(
        "hadolint", path=f"{sysconfig.get_path('scripts')}:{os.environ['PATH']}"
    )
    if hadolint is None:
        pytest.skip("hadolint is not installed")
    found = subprocess.run(
        [hadolint, "--no-color", ROOT / "Dockerfile"], capture_output=True, text=True
    )
    assert found.returncode == 0, found.stdout


def test_both_stages_are_slim_and_of_the_same_python() -> None:
    bases = [argument.split()[0] for name, argument in INSTRUCTIONS if name == "FROM"]
    assert len(bases) == 2
    assert len(set(bases)) == 1
    assert bases[0].endswith("-slim")


def test_the_final_stage_runs_nothing_and_takes_only_what_was_installed() -> None:
    assert "RUN" not in dict(FINAL)
    copied = [argument for name, argument in FINAL if name == "COPY"]
    assert all(argument.startswith("--from=build ") for argument in copied)


def test_the_one_place_that_is_written_belongs_to_the_user_and_outlives_a_read_only_root() -> None:
    cache = only("VOLUME")
    assert f"NUMBA_CACHE_DIR={cache}" in only("ENV").split()
    assert ("COPY", f"--from=build --chown={only('USER')} {cache} {cache}") in FINAL


def test_the_volume_of_fronts_belongs_to_the_user() -> None:
    [store] = [argument for name, argument in FINAL if name == "COPY" and "/var/lib" in argument]
    assert f"--chown={only('USER')} " in store


def test_nothing_of_the_factory_is_installed() -> None:
    [install] = [argument for name, argument in INSTRUCTIONS if "pip install" in argument]
    assert " '.[cluster,mcp,tracing]' " in install


def test_versions_are_those_of_the_constraints() -> None:
    [install] = [argument for name, argument in INSTRUCTIONS if "pip install" in argument]
    constraints = re.search(r"pip install --no-cache-dir -c (\S+) '", install)
    assert constraints is not None
    assert (ROOT / constraints[1]).exists()
    assert ("COPY", "service ./service") in INSTRUCTIONS
    assert constraints[1].startswith("service/")


def test_the_user_is_a_number_and_not_root() -> None:
    assert all(int(number) > 0 for number in only("USER").split(":"))


def test_commands_are_in_exec_form() -> None:
    assert json.loads(only("CMD")) == ["paretour", "serve"]
    assert health_command()[0] == "python"


def test_what_the_build_copies_is_there_and_not_ignored() -> None:
    copied = [argument for name, argument in INSTRUCTIONS if name == "COPY"]
    local = [argument.split()[:-1] for argument in copied if "--from" not in argument]
    sources = [source for each in local for source in each]
    ignored = (ROOT / ".dockerignore").read_text().splitlines()
    for source in sources:
        assert (ROOT / source).exists()
        assert f"!{source.removeprefix('./')}" in ignored


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the wheel is installed: its own code alone, beside the packages of the tests."""
    prefix = tmp_path_factory.mktemp("image") / "opt"
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "-q"]
    # Without the second option pip takes away what is installed in the environment of the tests.
    options = ["--no-deps", "--ignore-installed", "--no-build-isolation", "--prefix", prefix]
    subprocess.run([*pip, *options, ROOT], check=True)
    return prefix


@pytest.fixture
def environment(installed: Path) -> dict[str, str]:
    """As in the image: its variables, no home, and nothing of the working tree.

    But the search is interpreted, because to compile it anew takes half a minute.
    """
    [packages] = installed.glob("lib/*/site-packages")
    given = dict(re.findall(r"(\w+)=(\S+)", only("ENV")))
    return {
        **given,
        "PATH": f"{installed}/bin:{Path(sys.executable).parent}:{os.environ['PATH']}",
        "PYTHONPATH": str(packages),
        "NUMBA_CACHE_DIR": str(installed / "cache"),
        "NUMBA_DISABLE_JIT": "1",
        "PARETOUR_WORKERS": "1",
        "PARETOUR_PORT": str(free_port()),
        "HOME": "/nowhere",
    }


@pytest.fixture
def server(installed: Path, environment: dict[str, str]) -> Iterator[subprocess.Popen[bytes]]:
    command = json.loads(only("CMD"))
    assert shutil.which(command[0], path=environment["PATH"]) == f"{installed}/bin/paretour"
    with subprocess.Popen(command, cwd="/", env=environment) as process:
        yield process
        process.kill()


def healthy(environment: dict[str, str]) -> bool:
    ran = subprocess.run(health_command(), env=environment, capture_output=True, check=False)
    return ran.returncode == 0


def first_front(url: str) -> httpx.Response:
    cities = [[0, 0, 1, 3], [2, 5, 0, 0], [4, 1, 2, 2], [3, 3, 5, 1], [1, 4, 4, 4]]
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        try:
            request = {"coordinates": cities, "time_limit": 0, "repairs": 0}
            return httpx.post(f"{url}/front", json=request, timeout=20)
        except httpx.ConnectError:
            time.sleep(0.02)
    raise TimeoutError("the server must start within 60 s")


def test_the_image_answers_and_stops_cleanly(
    environment: dict[str, str], server: subprocess.Popen[bytes]
) -> None:
    answer = first_front(f"http://127.0.0.1:{environment['PARETOUR_PORT']}")
    assert answer.status_code == 200
    assert answer.json()["actor"]["name"] == "pa-one"
    assert healthy(environment)
    server.send_signal(signal.SIGTERM)
    assert server.wait(timeout=20) == 0


def test_what_the_build_compiles_is_there(environment: dict[str, str]) -> None:
    [command] = [json.loads(argument) for _, argument in INSTRUCTIONS if "precompile" in argument]
    # Imported and not called: even interpreted it takes some seconds.
    code = f"from {command[-1]} import main"
    subprocess.run(["python", "-c", code], cwd="/", env=environment, check=True)


def test_the_health_check_fails_where_nothing_listens(environment: dict[str, str]) -> None:
    assert not healthy(environment)
