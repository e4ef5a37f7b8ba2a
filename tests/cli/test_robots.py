"""`paretour coverage` with several robots: what it plans, prints and draws."""

import csv
import io
import json
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
from paretour import Actor, Plan, RobotFront, coverage_plan
from paretour.plans import parse_robots
from rich.console import Console

from service.cli.fronts import run_front
from service.cli.options import OutputFormat
from service.cli.plot import plot_map
from tests.helpers.command import paretour

GRID = [[0, 0, 0, 0]]
REQUEST: Any = {
    "grid": GRID,
    "cell_size": 1,
    "places": [[0, 0], [0, 1], [0, 3]],
    "robots": [{"id": "left $1$"}, {"id": "_right", "start": 2}],
    "closed": False,
}
OBJECTIVES = [
    {"name": "total distance", "unit": "m", "over": "sum"},
    {"name": "longest route", "unit": "m", "over": "max"},
]
ANSWER: dict[str, Any] = {
    "id": "",
    "kind": "robots",
    "status": "done",
    "cities": 3,
    "objectives": OBJECTIVES,
    "places": REQUEST["places"],
    "points": 1,
    "hypervolume": 0.5,
    "timings_ms": {},
    "terminated": "converged",
    "front": [
        {
            "balance": 0.5,
            "lengths": [1.0, 1.0],
            "routes": [
                {
                    "robot": "left $1$",
                    "tour": [0, 1],
                    "lengths": [1.0, 1.0],
                    "path": {"cells": [[0, 0], [0, 1]], "metres": 1.0},
                }
            ],
        }
    ],
}


class Prepared:
    """A backend that has its answer."""

    def front(self, plan: Plan, console: Console) -> RobotFront:
        """Return the answer."""
        del plan, console
        return parse_robots(ANSWER)

    def actors(self) -> tuple[Actor, ...]:
        """Return none."""
        return ()


def printed(capsys: pytest.CaptureFixture[str], **formats: bool) -> str:
    plan = coverage_plan(REQUEST, None)
    run_front(lambda: (plan, None), Prepared(), OutputFormat(**formats))  # type: ignore[arg-type]
    return capsys.readouterr().out


def test_plans_are_printed_in_three_formats(capsys: pytest.CaptureFixture[str]) -> None:
    assert json.loads(printed(capsys, as_json=True)) == ANSWER
    [row] = csv.DictReader(io.StringIO(printed(capsys, as_csv=True)))
    assert (row["plan"], row["robot"], row["places"]) == ("0", "left $1$", "0 1")
    assert (row["total distance"], row["route longest route"]) == ("1.0", "1.0")
    assert "│    0 │   0.500 │" in printed(capsys)


def test_a_map_with_plans_is_a_picture_of_a_panel_each(tmp_path: Path) -> None:
    path = tmp_path / "robots.png"
    plan = coverage_plan(REQUEST, None)
    plot_map(parse_robots(ANSWER), plan, path, {"a": 0, "b": 0})
    picture = matplotlib.image.imread(path)
    assert picture.shape[:2] == (750, 2250)
    blue = np.array([0x00, 0x72, 0xB2]) / 255  # of the first robot
    assert (np.abs(picture[..., :3] - blue).max(axis=-1) < 0.01).any()


def test_two_robots_share_a_map_of_ros(tmp_path: Path, quick_actors: dict[str, str]) -> None:
    (tmp_path / "map.pgm").write_bytes(b"P5 6 1 255\n" + bytes(6 * [254]))
    (tmp_path / "map.yaml").write_text(
        "image: map.pgm\nresolution: 0.5\norigin: [-2.0, 1.0, 0.0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    starts = ["--robot=-1.75,1.25", "--robot=0.75,1.25,3.14"]
    picture = tmp_path / "picture.svg"
    given = ["--spacing=0.5", "--open", *starts, "--json", "--plot", picture]
    ended = paretour("coverage", tmp_path / "map.yaml", *given, **quick_actors)
    assert ended.returncode == 0, ended.stderr
    last = json.loads(ended.stdout)["front"][-1]
    assert [route["robot"] for route in last["routes"]] == ["robot-1", "robot-2"]
    ends = [route["path"]["points"][0] for route in last["routes"]]
    assert ends == [[-1.75, 1.25], [0.75, 1.25]]
    assert last["lengths"] == [2.0, 1.0]
    assert "plans found" in ended.stderr
    assert "<svg" in picture.read_text()


@pytest.mark.parametrize("robots", [[], [{"id": "a"}, {"id": "b"}]])
def test_the_command_says_what_is_not_covered(
    robots: list[dict[str, str]], url: str, tmp_path: Path
) -> None:
    request: dict[str, Any] = {"grid": [[0, 0, 1, 0]], "cell_size": 2, "places": [[0, 0], [0, 1]]}
    more = {"robots": robots} if robots else {"second_matrix": [[0, 1], [1, 0]]}
    file = tmp_path / "map.json"
    file.write_text(json.dumps({**request, **more}))
    ended = paretour("coverage", file, "--url", url)
    assert ended.returncode == 0, ended.stderr
    said = " ".join(ended.stderr.split())
    assert "no path leads there: 1 free cell, 4 m²; the largest part is around [0, 3]" in said
