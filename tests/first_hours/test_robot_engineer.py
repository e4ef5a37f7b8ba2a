"""The hour of a robot engineer: the two files of a map become paths in the frame of the map."""

import csv
import json
import shlex
from pathlib import Path

import numpy as np
import yaml
from PIL import Image

from tests.first_hours.steps import command, run_program, says, write_files
from tests.guide.sessions import printed_by

PAGE = "cover-a-map"
START = (-1.2, 0.7)


def is_free(folder: Path, poses: np.ndarray) -> np.ndarray:
    """Return for each pose, shape (m, 2 or more), whether its cell of office.yaml is free."""
    settings = yaml.safe_load((folder / "office.yaml").read_text())
    with Image.open(folder / settings["image"]) as picture:
        shades = np.asarray(picture)
    columns, rows = np.floor(
        (poses[:, :2] - settings["origin"][:2]) / settings["resolution"]
    ).T.astype(int)
    return shades[len(shades) - 1 - rows, columns] == 254


def table_of(file: Path) -> np.ndarray:
    """Return x, y and yaw of each pose of a path's table."""
    with file.open() as text:
        rows = [(row["x"], row["y"], row["yaw"]) for row in csv.DictReader(text)]
    return np.array(rows, dtype=float)


def test_a_map_becomes_paths_of_one_robot_and_of_two(released: str, tmp_path: Path) -> None:
    write_files(PAGE, tmp_path, "office.pgm", "office.yaml", "people.csv")
    printed_by(command(PAGE, "paretour coverage", "--plot office.png"), tmp_path)
    assert (tmp_path / "office.png").read_bytes().startswith(b"\x89PNG")
    for name in ("path.json", "path.csv"):
        printed_by(command(PAGE, "paretour tour office.yaml", name), tmp_path)
    path = table_of(tmp_path / "path.csv")
    assert is_free(tmp_path, path).all()
    # It begins in the cell of the robot, and comes back.
    assert np.abs(path[0, :2] - START).max() <= 0.25
    np.testing.assert_array_equal(path[0, :2], path[-1, :2])
    message = json.loads((tmp_path / "path.json").read_text())
    sent = [each["pose"]["position"] for each in message["poses"]]
    assert message["header"]["frame_id"] == "map"
    np.testing.assert_allclose([[each["x"], each["y"]] for each in sent], path[:, :2])

    says(PAGE, "In Python:")
    client = run_program(PAGE, "to_nav_path", tmp_path, released)
    np.testing.assert_allclose(client["path"].poses, path, atol=1e-6)
    assert client["message"]["poses"][0]["pose"]["position"] == sent[0]

    robots = command(PAGE, "--path-folder paths")
    starts = [
        np.array(word.removeprefix("--robot=").split(",")[:2], dtype=float)
        for word in shlex.split(robots)
        if word.startswith("--robot=")
    ]
    printed_by(robots, tmp_path)
    both = [table_of(tmp_path / f"paths/plan-1-robot-{number}.csv") for number in (1, 2)]
    for start, driven in zip(starts, both, strict=True):
        assert is_free(tmp_path, driven).all()
        assert np.abs(driven[0, :2] - start).max() <= 0.25
