"""The commands, run as people run them, and what they leave on stdout and stderr."""

import csv
import io
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from paretour import Client
from PIL import Image
from typer.testing import CliRunner

from service import installed_version
from service.cli.commands import app
from tests.helpers.artifacts import by_row_sums
from tests.helpers.command import EXAMPLE, ROOT, paretour


def found(answer: dict[str, Any]) -> dict[str, Any]:
    """What does not depend on when and by whom it was found."""
    return {name: answer[name] for name in answer if name not in ("id", "timings_ms")}


@pytest.mark.parametrize(
    "options",
    [{"time_limit": 0, "repairs": 2, "augment": 3}, {"time_limit": 60, "seed": 3, "start": 2}],
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


def test_a_front_is_a_table_and_a_line_on_stderr(
    cities: Path, quick_actors: dict[str, str]
) -> None:
    ended = paretour("front", cities, "--size", 3, "--time-limit", 0, **quick_actors)
    assert ended.returncode == 0
    assert "first length" in ended.stdout
    assert ended.stderr.startswith("3 of ")
    assert "hypervolume" in ended.stderr


def test_a_front_may_be_lines_of_csv(cities: Path, quick_actors: dict[str, str]) -> None:
    arguments = ("front", cities, "--time-limit", 0, "--angles", "10,45,80")
    as_csv, as_json = (
        paretour(*arguments, form, **quick_actors).stdout for form in ("--csv", "--json")
    )
    rows = list(csv.DictReader(io.StringIO(as_csv)))
    front = json.loads(as_json)["front"]
    assert len(front) <= 3
    assert [
        {
            "angle": float(row["angle"]),
            "balance": item["balance"],
            "lengths": [float(row["length_1"]), float(row["length_2"])],
            "tour": [int(city) for city in row["tour"].split()],
        }
        for row, item in zip(rows, front, strict=True)
    ] == front


def test_a_front_is_drawn(cities: Path, tmp_path: Path, quick_actors: dict[str, str]) -> None:
    picture = tmp_path / "front.png"
    drawn = paretour("front", cities, "--time-limit", 0, "--plot", picture, **quick_actors)
    assert drawn.returncode == 0
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
    least = json.loads(paretour("tour", *arguments, "--balance", 1, "--json").stdout)
    assert least == front[-1]


def test_stops_come_back_by_their_ids(tmp_path: Path) -> None:
    costs = np.random.default_rng(0).random((4, 4)).tolist()
    names = ["depot", "order 1", "c", "d"]
    stops = [{"id": name, "location": [i / 100, i**2 / 200]} for i, name in enumerate(names)]
    objectives = [{"name": "way", "from": "great_circle"}, {"name": "risk", "matrix": costs}]
    file = tmp_path / "stops.json"
    file.write_text(json.dumps({"stops": stops, "objectives": objectives, "time_limit": 0}))
    by_row_sums(tmp_path / "sums.onnx")
    actors = {"PARETOUR_ACTORS": str(tmp_path)}
    ended = paretour("front", file, "--csv", "--start", "order 1", **actors)
    assert ended.returncode == 0, ended.stderr
    rows = list(csv.DictReader(ended.stdout.splitlines()))
    assert rows[0].keys() == {"angle", "way (m)", "risk", "tour"}
    assert all(row["tour"].startswith('"order 1" ') for row in rows)
    tour = paretour("tour", file, "--angle", 45, **actors)
    assert sorted(next(csv.reader([tour.stdout], delimiter=" "))) == sorted(names)
    assert re.search(r"way \S+ m, risk \S+", tour.stderr)
    refused = paretour("front", file, "--start", "ordr 1")
    assert refused.returncode == 2
    assert 'start must be the id of a stop, got "ordr 1"; did you mean "order 1"?' in refused.stderr


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
    options = ["--json", "--paths", "--time-limit=30"]  # far more than it takes to converge
    of_grid, of_picture = (
        paretour("coverage", *asked, *options, PARETOUR_ACTORS=str(tmp_path))
        for asked in ([tmp_path / "map.json"], [tmp_path / "map.png", *given])
    )
    answer = json.loads(of_picture.stdout)
    assert found(answer) == found(json.loads(of_grid.stdout))
    assert answer["terminated"] == "converged"
    assert all(item["path"]["metres"] > 0 for item in answer["front"])


def test_each_of_several_files_of_costs_is_an_objective_with_its_name(tmp_path: Path) -> None:
    Image.new("L", (8, 6), 255).save(tmp_path / "map.png")
    for seed, name in enumerate(("people", "noise")):
        drawn = np.random.default_rng(seed).random((6, 8))
        np.savetxt(tmp_path / f"{name}.csv", drawn, delimiter=",")
    costs = ["--cost-layer", tmp_path / "people.csv", "--cost-layer", tmp_path / "noise.csv"]
    asked = ["coverage", tmp_path / "map.png", *costs, "--cell-size=0.5", "--spacing=1"]
    answer = json.loads(paretour(*asked, "--json").stdout)
    names = [objective["name"] for objective in answer["objectives"]]
    assert names == ["distance", "people", "noise"]
    assert all(len(item["lengths"]) == 3 for item in answer["front"])


def test_a_map_of_ros_is_covered_as_the_same_map_in_a_message(tmp_path: Path) -> None:
    shades = np.full((5, 7), 254, np.uint8)
    shades[0], shades[1, :4], shades[4, 2:] = 205, 0, 205  # unknown, an obstacle, unknown
    (tmp_path / "map.pgm").write_bytes(b"P5 7 5 255\n" + shades.tobytes())
    (tmp_path / "map.yaml").write_text(
        "image: map.pgm\nresolution: 0.5\norigin: [-2.0, 1.0, 0.0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    data = np.array(
        [[{254: 0, 205: -1, 0: 100}[shade] for shade in row] for row in shades.tolist()]
    )
    pose = {"position": {"x": -2, "y": 1, "z": 0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}
    info = {"resolution": 0.5, "width": 7, "height": 5, "origin": pose}
    message = {"info": info, "data": data[::-1].ravel().tolist()}
    (tmp_path / "message.json").write_text(json.dumps(message))
    layer = np.random.default_rng(0).random((5, 7))
    np.savetxt(tmp_path / "people.csv", layer, delimiter=",", fmt="%.17g")
    by_row_sums(tmp_path / "sums.onnx")
    given = ["--cost-layer", tmp_path / "people.csv", "--spacing=1", "--start-pose=-1.9,1.1"]
    given.append("--time-limit=30")  # far more than it takes to converge
    picture = tmp_path / "picture.png"
    of_yaml, of_message = (
        paretour("coverage", tmp_path / name, *given, *more, PARETOUR_ACTORS=str(tmp_path))
        for name, more in (
            ("map.yaml", ["--json", "--plot", picture]),
            ("message.json", ["--json", "--paths"]),
        )
    )
    answer = json.loads(of_yaml.stdout)
    assert found(answer) == found(json.loads(of_message.stdout))
    for item in answer["front"]:
        assert item["path"]["points"][0] == [-1.75, 1.25]  # the cell at the lower left
        assert (data[tuple(np.transpose(item["path"]["cells"]))] == 0).all()
    assert picture.read_bytes().startswith(b"\x89PNG")
    one = ["tour", tmp_path / "map.yaml", *given, "--balance", "0"]
    ended = paretour(*one, PARETOUR_ACTORS=str(tmp_path))
    assert list(map(int, ended.stdout.split())) == answer["front"][0]["tour"], ended.stderr


WRONG = [
    (["front"], "Missing argument"),
    (["front", "none.json"], "none.json: No such file"),
    (["front", "README.md"], "README.md: "),
    (["front", EXAMPLE, "--start", "61"], "start must be a city, 0 to 60, got 61"),
    (["front", EXAMPLE, "--actor", "x"], "actor must be one of"),
    (["front", EXAMPLE, "--angles", "1,b"], "--angles must be numbers"),
    (["front", EXAMPLE, "--json", "--csv"], "as one of --json"),
    (["front", EXAMPLE, "--plot", "front.txt"], "--plot must end in one of"),
    (["front", EXAMPLE, "--plot", "none/front.png"], "in a directory that exists"),
    (["tour", EXAMPLE], "second_at_most, weights, at_most, knee must be given, got none"),
    (["tour", EXAMPLE, "--angle", "3", "--knee"], "must be given, got angle and knee"),
    (["tour", EXAMPLE, "--balance", "1.1"], "Invalid value for '--balance'"),
    (
        ["tour", EXAMPLE, "--time-limit", "0", "--first-at-most", "1"],
        "length of at most 1: the",
    ),
    (["tour"], "Missing argument"),
    (["tour", EXAMPLE, "--angle", "x"], "Invalid value for '--angle'"),
    (["tour", EXAMPLE, "--knee", "--cost-layer", "a.csv"], "--cost-layer is for a map"),
    (["coverage", "none.png"], "none.png: No such file"),
    (["coverage", "none.yaml"], "none.yaml: No such file"),
    (["coverage", "README.md", "--start-pose", "1;2"], "--start-pose must be numbers with commas"),
    (["front", EXAMPLE, "--url", "ftp://x"], "--url must be a URL"),
    (["coverage", "README.md"], "README.md: row 3 must have 1 field,"),
]


@pytest.mark.parametrize(("arguments", "sentence"), WRONG)
def test_a_mistake_of_the_caller_ends_with_2(
    arguments: list[object], sentence: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    ended = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert (ended.exit_code, ended.stdout) == (2, "")
    assert sentence in ended.stderr
    assert isinstance(ended.exception, SystemExit)


def test_without_matplotlib_a_plot_is_refused_before_anything_is_planned(cities: Path) -> None:
    code = (
        "import sys; sys.modules['matplotlib'] = None; from service.__main__ import main;"
        f"main(['front', {str(cities)!r}, '--plot', 'front.png'])"
    )
    ended = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "pip install 'paretour[plot]'" in ended.stderr


def test_the_version_is_printed() -> None:
    ended = CliRunner().invoke(app, ["--version"])
    assert (ended.exit_code, ended.stdout) == (0, f"paretour {installed_version()}\n")


def test_commands_and_options_can_be_completed() -> None:
    assert "--install-completion" in CliRunner().invoke(app, ["--help"]).stdout
    words = {"_PARETOUR_COMPLETE": "complete_bash", "COMP_WORDS": "paretour cov", "COMP_CWORD": "1"}
    assert paretour(**words).stdout.split() == ["coverage"]


def test_help_waits_for_nothing_heavy() -> None:
    code = (
        "import sys; from service.__main__ import main\n"
        "try: main(['front', '--help'])\n"
        "except SystemExit: sys.exit(len({'numpy', 'httpx', 'fastapi'} & set(sys.modules)))"
    )
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True)


def test_ctrl_c_while_the_command_loads_ends_with_130_and_no_traceback() -> None:
    code = (
        "import sys\n"
        "class Pressed:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name == 'service.cli.options': raise KeyboardInterrupt\n"
        "sys.meta_path.insert(0, Pressed())\n"
        "from service.__main__ import main; main(['--help'])"
    )
    ended = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True)
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, b"", b"")


def test_the_rest_of_a_front_of_a_service_is_replanned(url: str, tmp_path: Path) -> None:
    cities = np.random.default_rng(2).random((8, 4)).tolist()
    with Client(url) as client:
        front = client.front(coordinates=cities, time_limit=0.1)
    changes = tmp_path / "changes.json"
    changes.write_text(json.dumps({"add": [{"id": "new", "coordinates": [[0, 0], [1, 1]]}]}))
    options = ("--url", url, "--done", "0,3", "--remove", "5", "--json")
    rest = json.loads(paretour("replan", front.id, changes, *options).stdout)
    assert {tour["stops"][0] for tour in rest["front"]} == {"3"}
    assert {stop["id"] for stop in rest["stops"]} == {*"0123467", "new"}
    refused = paretour("replan", front.id, "--url", url, "--done", "x")
    assert refused.returncode == 2
    assert "done/0 must be the id of a stop" in refused.stderr
