"""A map.yaml of ROS, and the picture that it names, become members of a request."""

import os
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
        (YAML.replace("0.050000", "wide"), "resolution must be a number, got 'wide'"),
        (YAML.replace("0.050000", "[1]"), "resolution must be a number"),
        (YAML.replace(", 0.000000]", "]"), "origin must be x, y and yaw, got "),
        (YAML.replace("negate: 0", "negate: 2"), "negate must be 0 or 1, got '2'"),
        (YAML.replace("0.050000", ".nan"), "resolution must be a number"),
        (YAML.replace("0.050000", "nan"), "resolution must be a finite number, got 'nan'"),
        (YAML.replace("0.050000", "1e999"), "resolution must be a finite number"),
        (YAML.replace("0.050000", "&a [*a]"), "resolution must be a number"),
        (YAML.replace("negate: 0", "negate: [0]"), "negate must be 0 or 1, got ['0']"),
        (YAML.replace("negate: 0", "negate:"), "negate must be 0 or 1, got ''"),
        ("[" * 16_000, "must have at most 100 brackets"),
        ("[" * 90, "must be YAML"),
        (YAML + "#" * 2**16, "must have at most 65536 bytes, got more"),
    ],
)
def test_what_is_no_map_yaml_is_named(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(ValueError, match=re.escape(sentence)):
        read_ros_map(written(tmp_path, text))


def test_a_picture_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"other\.pgm"):
        read_ros_map(written(tmp_path, YAML.replace("map.pgm", "other.pgm")))


@pytest.mark.parametrize("negate", ['"0"', "'0'", "false", "!!bool no", "0", "No"])
def test_negate_is_read_however_it_is_written(tmp_path: Path, negate: str) -> None:
    (tmp_path / "map.yaml").write_text(YAML.replace("negate: 0", f"negate: {negate}"))
    write_picture(tmp_path)
    request, _ = read_ros_map(tmp_path / "map.yaml")
    assert request["negate"] is False


def test_what_a_map_yaml_says_constructs_nothing_and_multiplies_nothing(tmp_path: Path) -> None:
    bomb = "a: &a [x, x, x, x]\n" + "".join(
        f"{b}: &{b} [*{a}, *{a}, *{a}, *{a}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    bomb += "? *i\n: 1\n"  # as a key, too
    bomb += "k0: &k0 [x]\n" + "".join(f"k{k}: &k{k} [*k{k - 1}, *k{k - 1}]\n" for k in range(1, 40))
    bomb += "? *k39\n: 1\n"
    apply = "!!python/object/apply:os.system ['false']: 1\n"
    (tmp_path / "map.yaml").write_text(bomb + apply + YAML)
    write_picture(tmp_path)
    assert read_ros_map(tmp_path / "map.yaml")[0]["cell_size"] == 0.05


@pytest.mark.parametrize(
    "image", ["~nobody/x.pgm", "/dev/zero", ".", "a" * 5000, "none.pgm", "pipe"]
)
def test_a_picture_that_is_no_file_is_an_error_and_not_waited_for(
    tmp_path: Path, image: str
) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "map.yaml").write_text(YAML.replace("map.pgm", image))
    with pytest.raises((ValueError, OSError)):
        read_ros_map(tmp_path / "map.yaml")


def write_picture(folder: Path) -> None:
    (folder / "map.pgm").write_bytes(b"P5 1 1 255 \xff")
