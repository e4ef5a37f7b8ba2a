"""Both backends: this process, and a service."""

import io
import json
import os
import pty
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from paretour import front_plan
from PIL import Image
from rich.console import Console

from service.actor import load_actors
from service.api.app import Edge
from service.api.auth import Access
from service.api.keys import KeyHash, new_key
from service.cli.backends import LocalBackend, RemoteBackend
from service.cli.errors import UsageError
from service.cli.progress import LOADING
from service.jobs import compiled_code
from service.library import local_planner
from service.requests import road_measurer
from service.requests.road_measurer import BlockingMeasurer
from service.roads.client import RoadClient
from tests.helpers.actors import Shuffler
from tests.helpers.artifacts import by_row_sums
from tests.helpers.command import EXAMPLE, ROOT, paretour, started
from tests.helpers.fake_router import fake_osrm, replying, road_costs
from tests.helpers.sampled import few
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


def request_of(kind: str, folder: Path) -> list[object]:
    """The arguments that plan something of a kind for which the time limit is never enough."""
    if kind == "front":
        return ["front", EXAMPLE]
    path = folder / "request.json"
    if kind == "fleet":
        costs = np.random.default_rng(3).integers(1, 99, (2, 40, 40)).tolist()
        request = {
            "stops": [{"id": "0"}, *({"id": str(i), "demand": [1]} for i in range(1, 40))],
            "vehicles": [{"id": "van", "count": 9, "start": 0, "end": 0, "capacity": [5]}],
            "objectives": [
                {"name": name, "matrix": m} for name, m in zip("ab", costs, strict=True)
            ],
        }
        path.write_text(json.dumps(request))
        return ["fleet", path]
    Image.fromarray(np.full((60, 60), 255, np.uint8)).save(folder / "map.png")
    ros_map = folder / "map.yaml"
    ros_map.write_text(
        "image: map.png\nresolution: 1.0\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.25\n"
    )
    return ["coverage", ros_map, "--spacing", 6, "--robot", "1.5,1.5", "--robot", "50.5,50.5"]


@pytest.mark.parametrize(
    ("kind", "remote"),
    few(2, [(kind, remote) for kind in ("front", "fleet", "robots") for remote in (False, True)]),
)
def test_ctrl_c_ends_the_search_with_the_best_front_so_far(
    url: str, kind: str, remote: bool, tmp_path: Path
) -> None:
    terminal, other_end = pty.openpty()
    options = ["--url", url] if remote else []
    arguments = [*request_of(kind, tmp_path), "--json", "--time-limit", 60, *options]
    with started(*arguments, stderr=other_end) as running:
        os.close(other_end)
        shown = b""
        while b"hypervolume" not in shown:
            shown += os.read(terminal, 1024)
        running.send_signal(signal.SIGINT)
        assert running.stdout is not None
        answer = json.loads(running.stdout.read())
    os.close(terminal)
    assert running.returncode == 0
    assert (answer["status"], answer["terminated"]) == ("cancelled", "cancelled")
    assert len(answer["front"]) > (10 if kind == "front" else 0)


def test_ctrl_c_ends_a_call_of_the_network_in_this_process(tmp_path: Path) -> None:
    cities = tmp_path / "cities.json"
    cities.write_text(json.dumps(np.random.default_rng(4).random((3000, 4)).tolist()))
    terminal, other_end = pty.openpty()
    arguments = ["front", cities, "--time-limit", 0, "--repairs", 200]  # minutes
    with started(*arguments, stderr=other_end) as running:
        os.close(other_end)
        shown = b""
        while b"planning" not in shown:
            shown += os.read(terminal, 1024)
        running.send_signal(signal.SIGINT)
        assert running.wait(timeout=60) == 130
    os.close(terminal)


@pytest.fixture
def closing(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Close connections to a routing engine, as the end of the command's own process does."""
    opened: list[BlockingMeasurer] = []

    class Closing(BlockingMeasurer):
        def __init__(self, client: RoadClient) -> None:
            super().__init__(client)
            opened.append(self)

    monkeypatch.setattr(road_measurer, "BlockingMeasurer", Closing)
    yield
    for each in opened:
        each.close()


@pytest.mark.usefixtures("closing")
@pytest.mark.parametrize("command", ["front", "fleet"])
def test_this_process_asks_the_routing_engine_as_the_service_does(
    command: str, tmp_path: Path
) -> None:
    places = [[24.9 + 0.01 * i, 60.1 + 0.007 * (i * i % 5)] for i in range(8)]
    request: dict[str, Any] = {
        "stops": [{"id": f"order-{i}", "location": place} for i, place in enumerate(places)],
        "objectives": [
            {"name": "time", "from": "road_time"},
            {"name": "way", "from": "road_distance"},
        ],
        "time_limit": 0.2,
    }
    if command == "fleet":
        request["vehicles"] = [{"id": "van", "count": 3, "start": 0, "end": 0}]
    file = tmp_path / "request.json"
    file.write_text(json.dumps(request))
    with fake_osrm() as engine:
        router = {"PARETOUR_ROUTER_URL": engine.url, "PARETOUR_ROUTER": "osrm"}
        planned = paretour(command, file, "--json", **router)
        engine.misbehave = replying(503)
        failed = paretour(command, file, "--json", **router)
    assert planned.returncode == 0, planned.stderr
    answer = json.loads(planned.stdout)
    assert answer["front"]
    assert answer["timings_ms"]["roads"] > 0
    if command == "front":
        costs = road_costs(np.array(places), np.array(places))
        for each in answer["front"]:
            lengths = costs[:, each["tour"], np.roll(each["tour"], -1)].sum(axis=1)
            assert each["lengths"] == pytest.approx(lengths)
    assert (failed.returncode, failed.stdout) == (3, "")
    assert "(router-unavailable)" in failed.stderr
    assert "Traceback" not in failed.stderr


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
    monkeypatch.setattr(compiled_code, "_loaded", set())  # as in a process that planned nothing
    monkeypatch.setattr(local_planner, "load_from_cache", lambda _: False)  # where none did
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
