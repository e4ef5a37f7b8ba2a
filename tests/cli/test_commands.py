"""The command, run as people run it, and what it leaves on stdout, on stderr and as a code."""

import csv
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
from paretour import Client
from PIL import Image

from service.api.app import Edge
from service.api.auth import Access, KeyHash, new_key
from tests.helpers.artifacts import by_row_sums
from tests.helpers.serving import Shuffler, app_of, serving, serving_released

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "service/examples/city-deliveries.json"
COMMAND = [sys.executable, "-m", "service"]
Ended = subprocess.CompletedProcess[str]


def paretour(*arguments: object, **settings: str) -> Ended:
    command = [*COMMAND, *map(str, arguments)]
    return subprocess.run(
        command,
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        env={**os.environ, **settings},
    )


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with serving_released() as address:
        yield address


@pytest.fixture
def cities(tmp_path: Path) -> Path:
    """A file of so few cities that a search of them converges."""
    path = tmp_path / "cities.json"
    path.write_text(json.dumps(np.random.default_rng(2).random((10, 4)).tolist()))
    return path


def found(answer: dict[str, Any]) -> dict[str, Any]:
    """What does not depend on when and by whom it was found."""
    return {name: answer[name] for name in answer if name not in ("id", "timings_ms")}


@pytest.mark.parametrize(
    "options",
    [{"time_limit": 0, "augment": 3}, {"time_limit": 60, "seed": 3, "start": 2}],
    ids=["network", "converged"],
)
def test_every_way_to_ask_gives_the_same_front(
    url: str, cities: Path, options: dict[str, Any]
) -> None:
    request = {"coordinates": json.loads(cities.read_text()), **options}
    with Client(url) as client:
        by_client = client.front(**request)
    by_hand = httpx.post(f"{url}/front", json=request, timeout=90).json()
    given = [f"--{name.replace('_', '-')}={value}" for name, value in options.items()]
    in_process = json.loads(paretour("front", cities, "--json", *given).stdout)
    by_service = json.loads(paretour("front", cities, "--json", "--url", url, *given).stdout)
    assert by_hand["terminated"] == "converged"
    for answer in (by_client.document, in_process, by_service):
        assert found(dict(answer)) == found(by_hand)


def test_a_front_is_a_table_and_a_line_on_stderr(cities: Path) -> None:
    ended = paretour("front", cities, "--size", 3, "--time-limit", 0)
    assert ended.returncode == 0
    assert "first length" in ended.stdout
    assert ended.stderr.startswith("3 of ")
    assert "hypervolume" in ended.stderr


def test_a_front_may_be_lines_of_csv(cities: Path) -> None:
    arguments = ("front", cities, "--time-limit", 0, "--angles", "10,45,80")
    rows = list(csv.DictReader(io.StringIO(paretour(*arguments, "--csv").stdout)))
    front = json.loads(paretour(*arguments, "--json").stdout)["front"]
    assert len(front) <= 3
    assert [
        {
            "angle": float(row["angle"]),
            "lengths": [float(row["length_1"]), float(row["length_2"])],
            "tour": [int(city) for city in row["tour"].split()],
        }
        for row in rows
    ] == front


def test_a_front_is_drawn(cities: Path, tmp_path: Path) -> None:
    picture = tmp_path / "front.png"
    assert paretour("front", cities, "--time-limit", 0, "--plot", picture).returncode == 0
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_the_tour_at_an_angle_is_the_nearest_of_the_front(cities: Path) -> None:
    arguments = (cities, "--time-limit", 0, "--start", 4)
    front = json.loads(paretour("front", *arguments, "--json").stdout)["front"]
    nearest = min(front, key=lambda item: abs(item["angle"] - 30))
    as_json = paretour("tour", *arguments, "--angle", 30, "--json")
    assert json.loads(as_json.stdout) == nearest
    as_text = paretour("tour", *arguments, "--angle", 30)
    assert [int(city) for city in as_text.stdout.split()] == nearest["tour"]
    assert "angle" in as_text.stderr


def test_a_picture_of_a_map_is_covered_as_its_grid_is(tmp_path: Path) -> None:
    grid = np.zeros((6, 8), dtype=np.uint8)
    grid[2, :5] = 1
    layer = np.random.default_rng(0).random((6, 8))
    request = {"grid": grid.tolist(), "cost_layer": layer.tolist(), "cell_size": 0.5, "spacing": 1}
    (tmp_path / "map.json").write_text(json.dumps(request))
    Image.fromarray(255 * (1 - grid)).save(tmp_path / "map.png")
    np.savetxt(tmp_path / "people.csv", layer, delimiter=",", fmt="%.17g")
    by_row_sums(tmp_path / "sums.onnx")
    given = ["--cost-layer", tmp_path / "people.csv", "--cell-size=0.5", "--spacing=1"]
    of_grid, of_picture = (
        paretour("coverage", *asked, "--json", "--paths", PARETOUR_ACTORS=str(tmp_path))
        for asked in ([tmp_path / "map.json"], [tmp_path / "map.png", *given])
    )
    answer = json.loads(of_picture.stdout)
    assert found(answer) == found(json.loads(of_grid.stdout))
    assert answer["terminated"] == "converged"
    assert all(item["path"]["metres"] > 0 for item in answer["front"])


def test_the_actors_are_those_of_the_service(url: str) -> None:
    here = paretour("actors", "--json")
    there = paretour("actors", "--json", "--url", url)
    assert json.loads(here.stdout) == json.loads(there.stdout) == httpx.get(f"{url}/actors").json()
    assert "pa-one" in paretour("actors").stdout


WRONG = [
    (["front"], "Missing argument"),
    (["front", "none.json"], "none.json: No such file"),
    (["front", "README.md"], "README.md: "),
    (["front", EXAMPLE, "--start", "61"], "start must be a city, 0 to 60, got 61"),
    (["front", EXAMPLE, "--actor", "x"], "actor must be one of"),
    (["front", EXAMPLE, "--angles", "1,b"], "--angles must be numbers"),
    (["front", EXAMPLE, "--json", "--csv"], "not as both"),
    (["front", EXAMPLE, "--plot", "front.txt"], "--plot must end in one of"),
    (["front", EXAMPLE, "--plot", "none/front.png"], "in a directory that is there"),
    (["tour", EXAMPLE], "Missing option"),
    (["coverage", "none.png"], "none.png: No such file"),
    (["coverage", "README.md"], "README.md: must be JSON"),
]


@pytest.mark.parametrize(("arguments", "sentence"), WRONG)
def test_what_the_caller_can_put_right_ends_with_2(arguments: list[object], sentence: str) -> None:
    ended = paretour(*arguments)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert sentence in ended.stderr
    assert "Traceback" not in ended.stderr


def test_what_the_service_refuses_ends_with_2(url: str) -> None:
    ended = paretour("front", EXAMPLE, "--start", 61, "--url", url)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "start must be a city, 0 to 60, got 61" in ended.stderr


def test_a_service_that_is_not_there_ends_with_3(cities: Path) -> None:
    ended = paretour("front", cities, "--url", "http://127.0.0.1:1")
    assert (ended.returncode, ended.stdout) == (3, "")
    assert "does not answer" in ended.stderr


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


def test_without_matplotlib_a_plot_is_refused_before_anything_is_planned(cities: Path) -> None:
    code = (
        "import sys; sys.modules['matplotlib'] = None; from service.__main__ import main;"
        f"main(['front', {str(cities)!r}, '--plot', 'front.png'])"
    )
    ended = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "pip install 'paretour[plot]'" in ended.stderr


@pytest.mark.parametrize("by_service", [False, True])
def test_ctrl_c_ends_the_search_with_the_best_front_so_far(url: str, by_service: bool) -> None:
    terminal, its_end = pty.openpty()
    command = [*COMMAND, "front", str(EXAMPLE), "--json", "--time-limit", "60"]
    command += ["--url", url] if by_service else []
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=its_end) as running:
        os.close(its_end)
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
        command = [*COMMAND, "front", str(cities), "--url", address, "--time-limit", "0"]
        with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE) as running:
            while not (tmp_path / "gate.started").exists():
                time.sleep(0.05)
            running.send_signal(signal.SIGINT)
            assert running.stdout is not None
            assert running.stdout.read() == b""
        (tmp_path / "gate").touch()
    assert running.returncode == 130


def test_help_waits_for_nothing_heavy() -> None:
    code = (
        "import sys; from service.__main__ import main\n"
        "try: main(['front', '--help'])\n"
        "except SystemExit: sys.exit(len({'numpy', 'httpx', 'fastapi'} & set(sys.modules)))"
    )
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True)


def test_with_a_service_neither_compiler_nor_network_is_loaded() -> None:
    code = (
        "import sys, service.commands.run;"
        "sys.exit(len({'numba', 'onnxruntime', 'fastapi'} & set(sys.modules)))"
    )
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True)
