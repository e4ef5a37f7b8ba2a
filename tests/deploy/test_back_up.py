"""What the guide says of backups: scripts run on a service that goes on, and bring all back."""

import subprocess
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from tests.guide.pages import GUIDE, blocks
from tests.helpers.processes import ServeProcess, serve_process
from tests.helpers.redis_server import LASTING, redis_server
from tests.helpers.required import give_up
from tests.helpers.sampled import at_night
from tests.helpers.serving import serving_settings

REQUEST = {
    "coordinates": np.random.default_rng(1).random((9, 4)).tolist(),
    "time_limit": 0,
    "repairs": 0,
}
SCRIPTS = {
    block.title: block.text for block in blocks(GUIDE / "back-it-up.md") if block.language == "sh"
}


def run(script: str, *arguments: object) -> None:
    subprocess.run(
        ["sh", "-c", SCRIPTS[script], script, *map(str, arguments)],
        check=True,
        timeout=60,
        capture_output=True,
    )


def planned(service: ServeProcess) -> dict[str, Any]:
    answer = httpx.post(f"{service.url}/front", json=REQUEST, timeout=300)
    assert answer.status_code == 200, answer.text
    front: dict[str, Any] = answer.json()
    return front


def front_of(url: str, front: dict[str, Any]) -> httpx.Response:
    return httpx.get(f"{url}/front/{front['id']}")


def test_a_running_service_is_backed_up_and_restored(
    tmp_path: Path, quick_actors: dict[str, str]
) -> None:
    store, copy = tmp_path / "fronts.sqlite", tmp_path / "monday"
    settings = {"PARETOUR_STORE": str(store), "PARETOUR_WORKERS": "1", **quick_actors}
    with serve_process(settings) as service:
        before = planned(service)
        run("back-up.sh", service.process.pid, store, copy)
        after = planned(service)
        run("back-up.sh", service.process.pid, store, tmp_path / "tuesday")
        assert front_of(service.url, before).json() == before
        service.process.kill()
        service.process.wait()
    assert Path(f"{store}-wal").exists()
    assert copy.stat().st_mode & 0o77 == 0
    store.write_bytes(b"lost")
    run("restore.sh", copy, store)
    with serving_settings(settings) as url:
        assert front_of(url, before).json() == before
        assert front_of(url, after).status_code == 404
    run("restore.sh", tmp_path / "tuesday", store)  # over the backup before it
    with serving_settings(settings) as url:
        assert front_of(url, before).json() == before
        assert front_of(url, after).json() == after


@pytest.mark.parametrize("folder", [pytest.param(None, marks=at_night), "gone"])
def test_a_store_that_cannot_be_backed_up_says_so_and_goes_on(
    tmp_path: Path, quick_actors: dict[str, str], folder: str | None
) -> None:
    store = ":memory:" if folder is None else str(tmp_path / "fronts.sqlite")
    if folder is not None:
        (tmp_path / "fronts.sqlite.backup.part").mkdir()
    with serve_process(
        {"PARETOUR_STORE": store, "PARETOUR_WORKERS": "1", **quick_actors}
    ) as service:
        front = planned(service)
        subprocess.run(["kill", "-USR1", str(service.process.pid)], check=True)
        assert front_of(service.url, front).json() == front
    assert b"the store cannot be backed up" in service.log


def test_a_running_redis_is_backed_up_and_restored(tmp_path: Path) -> None:
    redis = pytest.importorskip("redis")
    old, new = tmp_path / "old", tmp_path / "new"
    for folder in (old, new):
        folder.mkdir()
    with redis_server(old, LASTING) as server:
        connection = redis.Redis.from_url(server.url)
        connection.hset("paretour:front:a", "members", b"\0{}")
        try:
            run("back-up-redis.sh", server.url, tmp_path / "copy.rdb")
        except FileNotFoundError:
            give_up("redis-cli is not installed")
        connection.hset("paretour:front:b", "members", b"{}")
    with redis_server(tmp_path) as free:
        port = free.port
    run("restore-redis.sh", tmp_path / "copy.rdb", new, port)
    with redis_server(new, LASTING) as server:
        connection = redis.Redis.from_url(server.url)
        assert connection.hgetall("paretour:front:a") == {b"members": b"\0{}"}
        assert connection.keys("*") == [b"paretour:front:a"]
