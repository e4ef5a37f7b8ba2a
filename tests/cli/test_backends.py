"""Both backends: this process, and a service."""

import json
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import httpx
import pytest

from service.api.app import Edge
from service.api.auth import Access, KeyHash, new_key
from tests.helpers.actors import Shuffler
from tests.helpers.command import EXAMPLE, ROOT, paretour, started
from tests.helpers.serving import app_of, serving


def test_the_actors_are_those_of_the_service(url: str) -> None:
    local = paretour("actors", "--json")
    remote = paretour("actors", "--json", "--url", url)
    assert (
        json.loads(local.stdout) == json.loads(remote.stdout) == httpx.get(f"{url}/actors").json()
    )
    assert "pa-one" in paretour("actors").stdout


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


def test_with_a_service_neither_compiler_nor_network_is_loaded() -> None:
    code = (
        "import sys, service.cli.backends, service.cli.output, service.cli.plans;"
        "sys.exit(len({'numba', 'onnxruntime', 'fastapi'} & set(sys.modules)))"
    )
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True)
