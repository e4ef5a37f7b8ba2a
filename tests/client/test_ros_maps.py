"""A map.yaml of ROS, and the picture that it names, become members of a request."""

import re
from pathlib import Path

import pytest
from paretour import read_ros_map

# The file of TurtleBot3 (ROBOTIS-GIT/turtlebot3, turtlebot3_navigation2/map) with another picture.
YAML = """image: map.pgm
resolution: 0.050000
origin: [-10.000000, -10.000000, 0.000000]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def written(folder: Path, text: str, picture: str = "map.pgm") -> Path:
    (folder / picture).write_bytes(b"P5 1 1 255\n\xfe")
    path = folder / "map.yaml"
    path.write_text(text)
    return path


def test_the_keys_become_members_and_the_picture_is_beside_the_file(tmp_path: Path) -> None:
    request, picture = read_ros_map(written(tmp_path, YAML))
    assert request == {
        "cell_size": 0.05,
        "origin": [-10.0, -10.0, 0.0],
        "mode": "trinary",
        "negate": False,
        "occupied_thresh": 0.65,
        "free_thresh": 0.196,
    }
    assert picture == b"P5 1 1 255\n\xfe"


def test_other_ways_to_write_the_same_are_read(tmp_path: Path) -> None:
    text = f"""# saved by Nav2
image: "{tmp_path}/my map.pgm"
mode: Scale
resolution: 5e-2
origin:
- -1
- 2.5
- 1.57
negate: true
occupied_thresh: 0.65
free_thresh: 0.25
"""
    request, _ = read_ros_map(written(tmp_path, text, "my map.pgm"))
    assert (request["mode"], request["negate"]) == ("scale", True)
    assert (request["cell_size"], request["origin"]) == (0.05, [-1.0, 2.5, 1.57])


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "must be keys with values"),
        ("- 1\n", "must be keys with values"),
        ("image: [\n", "must be YAML: "),
        ("image: map.pgm\nnegate: 0\n", "must have resolution, origin, occupied_thresh, free_thre"),
        (YAML.replace("0.050000", "wide"), "resolution must be a number, got wide"),
        (YAML.replace("0.050000", "[1]"), "resolution must be a number"),
        (YAML.replace(", 0.000000]", "]"), "origin must be x, y and yaw, got "),
        (YAML.replace("negate: 0", "negate: 2"), "negate must be 0 or 1, got 2"),
        ("a: &a [1]\nb: *a\n" + YAML, "must have no aliases"),
        (YAML + "!!python/object/apply:os.system ['true']: 1\n", "must be YAML: "),
        ("[" * 1000, "must be YAML"),
        (YAML + "#" * 2**16, "must have at most 65536 bytes, got more"),
    ],
)
def test_what_is_no_map_yaml_is_named(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(ValueError, match=re.escape(sentence)):
        read_ros_map(written(tmp_path, text))


def test_a_picture_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"other\.pgm"):
        read_ros_map(written(tmp_path, YAML.replace("map.pgm", "other.pgm")))
