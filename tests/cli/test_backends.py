"""Both backends: this process, and a service."""

import io
import json
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import httpx
import numpy as np
import pytest
from paretour import front_plan
from rich.console import Console

from service.actor import load_actors
from service.api.app import Edge
from service.api.auth import Access, KeyHash, new_key
from service.cli.backends import LOADING, LocalBackend, RemoteBackend
from service.cli.errors import UsageError
from tests.helpers.actors import Shuffler
from tests.helpers.artifacts import by_row_sums
from tests.helpers.command import EXAMPLE, ROOT, paretour, started
from tests.helpers.serving import app_of, serving


def test_the_actors_are_those_of_the_service(url: str) -> None:
    local = paretour("actors", "--json")
    remote = paretour("actors", "--json", "--url", url)
    assert (
        json.loads(local.stdout) == json.loads(remote.stdout) == httpx.get(f"{url}/actors").json()
    )
    assert "pa-one" in paretour("actors").stdout


def test_an_actor_of_ones_own_stands_beside_the_others(tmp_path: Path) -> None:
    by_row_sums(tmp_path / "sums.onnx")
    listed = paretour("actors", "--json", PARETOUR_OWN_ACTORS=str(tmp_path))
    names = [actor["name"] for actor in json.loads(listed.stdout)["actors"]]
    assert {"pa-one", load_actors(tmp_path, 1).popitem()[0]} <= set(names)
    assert len(names) == 6


def test_a_key_is_given_by_option_or_by_variable(cities: Path) -> None:
    key, digest = new_key()
    edge = Edge(access=Access([KeyHash(caller="me", digest=digest)]))
    with serving(app_of(edge=edge)) as address:
        asked = ("front", cities, "--time-limit", 0, "--url", address)
        assert paretour(*asked, "--api-key", key).returncode == 0
        assert paretour(*asked, PARETOUR_API_KEY=key).returncode == 0
        refused = paretour(*asked, "--api-key", digest)
    assert refused.returncode == 3
    assert "(unauthorized)" in refused.stderr


@pytest.mark.parametrize("remote", [False, True])
def test_ctrl_c_ends_the_search_with_the_best_front_so_far(url: str, remote: bool) -> None:
    terminal, other_end = pty.openpty()
    options = ["--url", url] if remote else []
    arguments = ["front", EXAMPLE, "--json", "--time-limit", 60, *options]
    with started(*arguments, stderr=other_end) as running:
        os.close(other_end)
        shown = b""
        while b"hypervolume" not in shown:
            shown += os.read(terminal, 1024)
        running.send_signal(signal.SIGINT)
        began = time.monotonic()
        assert running.stdout is not None
        answer = json.loads(running.stdout.read())
    os.close(terminal)
    assert running.returncode == 0
    assert time.monotonic() - began < 30
    assert (answer["status"], answer["terminated"]) == ("cancelled", "cancelled")
    assert len(answer["front"]) > 10


def test_ctrl_c_before_there_is_a_front_ends_with_130(cities: Path, tmp_path: Path) -> None:
    with serving(app_of(Shuffler(gate=tmp_path / "gate"))) as address:
        with started("front", cities, "--url", address, "--time-limit", 0) as running:
            while not (tmp_path / "gate.started").exists():
                time.sleep(0.05)
            running.send_signal(signal.SIGINT)
            assert running.stdout is not None
            assert running.stdout.read() == b""
        (tmp_path / "gate").touch()
    assert running.returncode == 130


COMPILES = [
    ({"time_limit": 0, "repairs": 0}, False),
    ({"time_limit": 0}, True),  # the best subset of what the network builds and visits
    ({"time_limit": 0, "bound": True}, True),
    ({"time_limit": 0, "repairs": 0, "size": 1}, True),
    ({"time_limit": 0.01}, True),
]


@pytest.mark.parametrize(("options", "compiles"), COMPILES)
def test_the_compilation_is_announced_where_compiled_code_is_run(
    options: dict[str, float], compiles: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    announced: list[str] = []
    console = Console(file=io.StringIO())
    status = console.status
    monkeypatch.setattr(console, "status", lambda text: announced.append(text) or status(text))
    coordinates = np.random.default_rng(0).random((6, 4)).tolist()
    LocalBackend().front(front_plan({"coordinates": coordinates, **options}), console)
    assert announced == [LOADING] * compiles


def test_what_is_refused_is_refused_before_anything_is_compiled() -> None:
    console = Console(file=io.StringIO())
    console.status = None  # type: ignore[assignment]
    with pytest.raises(UsageError, match="seed must be"):
        LocalBackend().front(front_plan({"coordinates": [[0, 0, 1, 1]], "seed": -1}), console)


def test_a_url_without_a_scheme_is_of_http(url: str, cities: Path) -> None:
    address = url.removeprefix("http://")
    assert paretour("front", cities, "--time-limit", 0, "--url", address).returncode == 0


@pytest.mark.parametrize("url", ["", "ftp://localhost", "http://", "http://[::1", "a:b:c"])
def test_what_is_no_url_is_refused(url: str) -> None:
    with pytest.raises(UsageError, match="--url must be a URL"):
        RemoteBackend(url, None).actors()


def test_with_a_service_neither_compiler_nor_network_is_loaded() -> None:
    code = (
        "import sys, service.cli.backends, service.cli.output, service.cli.plans;"
        "sys.exit(len({'numba', 'onnxruntime', 'fastapi'} & set(sys.modules)))"
    )
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True)
