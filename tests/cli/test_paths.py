"""`paretour tour --path` and `paretour coverage --path-folder`: files for robots."""

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from tests.helpers.command import paretour

REQUEST: dict[str, Any] = {
    "grid": [[0, 0, 0, 0], [0, 1, 1, 0], [0, 0, 0, 0]],
    "cell_size": 0.5,
    "origin": [-2.0, 1.0, 0],
    "places": [[0, 0], [2, 0], [2, 3], [0, 2]],
    "cost_layer": [[1, 1, 1, 1], [0, 0, 0, 9], [0, 0, 0, 1]],
}
ROBOTS = [{"id": "../left"}, {"id": "right", "start": 2}]


def write(folder: Path, **changed: Any) -> Path:
    """Write a request into a file; None removes a member."""
    file = folder / "map.json"
    members = {**REQUEST, **changed}
    file.write_text(json.dumps({k: v for k, v in members.items() if v is not None}))
    return file


def positions(message: dict[str, Any]) -> list[tuple[float, float]]:
    places = [pose["pose"]["position"] for pose in message["poses"]]
    return [(place["x"], place["y"]) for place in places]


def rows_of(file: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(file.read_text().splitlines()))


def test_a_tour_has_its_path_written(tmp_path: Path, url: str) -> None:
    file, found = write(tmp_path), {}
    for ending in ("json", "csv"):
        written = tmp_path / f"path.{ending}"
        given = ("tour", file, "--balance=0", "--path", written, "--url", url)
        ended = paretour(*given)
        assert ended.returncode == 0, ended.stderr
        found[ending] = [int(place) for place in ended.stdout.split()]
    rows = rows_of(tmp_path / "path.csv")
    assert [int(row["place"]) for row in rows if row["place"]] == [*found["csv"], found["csv"][0]]
    message = json.loads((tmp_path / "path.json").read_text())
    assert message["header"]["frame_id"] == "map"
    assert positions(message) == [(float(row["x"]), float(row["y"])) for row in rows]


@pytest.mark.parametrize(
    ("more", "names"),
    [({}, {"tour-0"}), ({"robots": ROBOTS, "cost_layer": None}, {"plan-0-_left", "plan-0-right"})],
)
def test_all_paths_of_a_front_are_written(
    more: dict[str, Any], names: set[str], tmp_path: Path, url: str
) -> None:
    folder = tmp_path / "paths"
    ended = paretour("coverage", write(tmp_path, **more), "--path-folder", folder, "--url", url)
    assert ended.returncode == 0, ended.stderr
    written = {file.stem for file in folder.iterdir()}
    assert written & names
    assert {file.name for file in folder.iterdir()} == {
        f"{stem}{suffix}" for stem in written for suffix in (".json", ".csv")
    }
    for stem in written:
        message = json.loads((folder / f"{stem}.json").read_text())
        assert len(message["poses"]) == len(rows_of(folder / f"{stem}.csv")) > 1


@pytest.mark.parametrize(
    ("changed", "options", "said"),
    [
        ({"origin": None}, ["--path", "p.csv"], "only for a map with an origin"),
        ({}, ["--path", "p.txt"], "--path must end in .json or .csv"),
        ({}, ["--path", "none/p.csv"], "--path must be in a directory that exists"),
    ],
)
def test_a_path_that_cannot_be_written_is_refused(
    changed: dict[str, Any], options: list[str], said: str, tmp_path: Path, url: str
) -> None:
    given = [options[0], tmp_path / options[1]]
    ended = paretour("tour", write(tmp_path, **changed), "--balance=0", *given, "--url", url)
    assert ended.returncode == 2
    assert said in " ".join(ended.stderr.split())


@pytest.mark.parametrize(
    ("folder", "said"),
    [
        ("none/paths", "--path-folder must be in a directory that exists"),
        ("map.json", "--path-folder must be a directory, got"),
    ],
)
def test_paths_need_a_folder(folder: str, said: str, tmp_path: Path, url: str) -> None:
    given = ["--path-folder", tmp_path / folder, "--url", url]
    ended = paretour("coverage", write(tmp_path), *given)
    assert ended.returncode == 2
    assert said in " ".join(ended.stderr.split())


def test_robots_whose_names_have_the_same_letters_have_files_of_their_own(
    tmp_path: Path, url: str
) -> None:
    named = [{**robot, "id": name} for robot, name in zip(ROBOTS, "#!", strict=True)]
    folder = tmp_path / "paths"
    file = write(tmp_path, robots=named, cost_layer=None)
    ended = paretour("coverage", file, "--json", "--path-folder", folder, "--url", url)
    assert ended.returncode == 0, ended.stderr
    routes = sum(len(plan["routes"]) for plan in json.loads(ended.stdout)["front"])
    assert len(list(folder.glob("*.csv"))) == routes
