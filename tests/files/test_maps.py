"""Maps as people have them, with the costs of their cells beside them."""

import io
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile

ROWS, COLUMNS = 5, 7
SHADES = np.full((ROWS, COLUMNS), 254, np.uint8)
SHADES[0], SHADES[2, 3], SHADES[3, 3] = 0, 205, 0
COSTS = np.arange(ROWS * COLUMNS).reshape(ROWS, COLUMNS)
WALLS = (SHADES != 254).astype(int).tolist()
ARENA = "type octile\nheight 3\nwidth 5\nmap\n@@.@@\n..GS.\nTWO..\n"
ARENA_GRID = [[1, 1, 0, 1, 1], [0, 0, 0, 0, 0], [1, 1, 1, 0, 0]]


def pgm(shades: NDArray[np.uint8]) -> bytes:
    rows, columns = shades.shape
    return b"P5\n# CREATOR: map_saver\n%d %d\n255\n" % (columns, rows) + shades.tobytes()


def png(shades: NDArray[Any]) -> bytes:
    with io.BytesIO() as file:
        Image.fromarray(shades).save(file, "PNG")
        return file.getvalue()


def csv(costs: NDArray[Any], separator: str = ",") -> bytes:
    return "\n".join(separator.join(map(str, row)) for row in costs).encode()


def yaml(image: str = "office.pgm", **keys: Any) -> bytes:
    known = {"resolution": 0.05, "origin": "[-1, -2, 0.3]", "negate": 0, "image": image}
    thresholds = {"occupied_thresh": 0.65, "free_thresh": 0.196}
    return "".join(
        f"{key}: {value}\n" for key, value in {**known, **thresholds, **keys}.items()
    ).encode()


OFFICE = {"office.yaml": yaml(), "office.pgm": pgm(SHADES)}


def read(files: dict[str, bytes], cells: int = 10**6) -> Reading:
    named = [NamedFile(name, files[name]) for name in sorted(files)]
    return read_files(named, Bounds(cells=cells), wanted="front")


def layer_in(costs: bytes, name: str = "people.csv") -> list[list[float]]:
    [layer] = read({**OFFICE, name: costs}).request["cost_layers"]
    assert layer["name"] == name.partition(".")[0]
    rows: list[list[float]] = layer["layer"]
    return rows


@pytest.mark.parametrize(
    "said",
    [
        yaml(),
        yaml(mode="trinary"),
        yaml(mode="trinary", free_thresh=0.25),  # as Nav2 writes it
        yaml("./maps/office.pgm"),
        yaml("/home/robot/maps/office.pgm"),
        yaml('"office.pgm"'),
        yaml(negate="false"),
        yaml(origin="\n- -1\n- -2\n- 0.3"),
        yaml().replace(b"\n", b"\r\n"),
        b"\xef\xbb\xbf" + yaml(),
    ],
)
def test_a_map_of_ros_is_read_however_its_yaml_is_written(said: bytes) -> None:
    reading = read({"office.yaml": said, "office.pgm": pgm(SHADES)})
    assert reading.request == {"grid": WALLS, "cell_size": 0.05, "origin": [-1, -2, 0.3]}
    assert np.sum(reading.unknown_cells) == 1
    assert not reading.notes


def test_a_picture_that_the_map_yaml_does_not_name_is_taken_with_a_note() -> None:
    reading = read({"office.yaml": yaml("old.pgm"), "office.pgm": pgm(SHADES)})
    assert reading.request["grid"] == WALLS
    assert [note.text for note in reading.notes] == [
        "It is taken for the map, which map.yaml calls 'old.pgm'."
    ]


@pytest.mark.parametrize(
    "costs",
    [
        csv(COSTS),  # its first row counts, as a heading of pandas does
        csv(COSTS, "\t"),
        csv(COSTS, ";"),
        csv(np.vstack((np.arange(COLUMNS), COSTS))),  # with a heading of pandas
        b",0,1,2,3,4,5,6\n" + csv(np.hstack((np.arange(ROWS)[:, np.newaxis], COSTS))),
        b"a,b,c,d,e,f,g\n" + csv(COSTS),
    ],
)
def test_costs_of_cells_are_read_however_programs_write_them(costs: bytes) -> None:
    assert layer_in(costs) == COSTS.tolist()


def test_a_picture_of_costs_is_dark_where_they_are_high() -> None:
    for picture in (png(SHADES), pgm(SHADES)):
        layer = layer_in(picture, "dust.png")
        np.testing.assert_allclose(layer, (255 - SHADES.astype(float)) / 255, atol=1e-3)


def test_a_picture_of_16_bits_keeps_its_fine_shades() -> None:
    shades = np.linspace(0, 65535, ROWS * COLUMNS).astype(np.uint16).reshape(ROWS, COLUMNS)
    shades[0, 1] = 10  # of 8 bits it would be black
    head = b"P5 %d %d 65535\n" % (COLUMNS, ROWS)
    for name, picture in {
        "noise.png": png(shades),
        "noise.pgm": head + shades.astype(">u2").tobytes(),
    }.items():
        layer = layer_in(picture, name)
        np.testing.assert_allclose(layer, (65535 - shades.astype(float)) / 65535, atol=1e-5)
        assert layer[0][0] == 1 > layer[0][1]
    reading = read({**OFFICE, "noise.png": png(shades)})
    assert "Of 16 bits, white is 65535 and black 0." in reading.notes[-1].text


@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({"a.png": png(SHADES[1:])}, "a.png: must have 5 x 7 costs, .* got 4 x 7"),
        ({"a.png": png(np.ascontiguousarray(SHADES.T))}, "must have 5 x 7 costs, .* got 7 x 5"),
        ({"a.csv": csv(COSTS[:, 1:])}, "a.csv: must have 5 x 7 costs, .* got 5 x 6"),
        (
            {"a.csv": csv(COSTS - 1)},
            "a.csv: row 1, column 1 of its costs must be 0 or more",
        ),
        ({"a.csv": csv(np.where(COSTS == 9, np.nan, COSTS))}, "a.csv: row 2.*number, got 'nan'"),
        (
            {"a.yaml": yaml("a.pgm"), "a.pgm": pgm(SHADES)},
            "office.yaml: a map has one map.yaml, got a.yaml as well",
        ),
        (
            {"keepout.yaml": yaml("keepout.pgm", mode="scale"), "keepout.pgm": pgm(SHADES)},
            "keepout.yaml: a map has one map.yaml, got office.yaml as well. To read the mask"
            " 'keepout.pgm' as a cost layer, .* open it without keepout.yaml. .* in 'office.pgm'",
        ),
        (
            {"a_speed.yaml": yaml("a_speed.pgm", mode="raw"), "a_speed.pgm": pgm(SHADES)},
            "a_speed.yaml: .* got office.yaml as well.* open it without a_speed.yaml",
        ),
        ({f"{at}.csv": csv(COSTS) for at in range(4)}, "must have at most 3 cost layers, got 4"),
        ({"arena.map": ARENA.encode()}, "a map must come once, got it as arena.map and as office"),
    ],
)
def test_what_is_not_a_cost_for_each_cell_is_refused_by_its_name(
    files: dict[str, bytes], said: str
) -> None:
    with pytest.raises(UnreadableFile, match=said):
        read({**OFFICE, **files})


def test_layers_have_names_of_their_own() -> None:
    files = {"distance.csv": csv(COSTS), "dust.csv": csv(COSTS), "dust.png": png(SHADES)}
    layers = read({**OFFICE, **files}).request["cost_layers"]
    assert [layer["name"] for layer in layers] == ["distance 2", "dust", "dust 2"]
    [layer] = read({**OFFICE, f"{150 * 'x'}.csv": csv(COSTS)}).request["cost_layers"]
    assert len(layer["name"]) <= 100


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
@pytest.mark.parametrize("after", ["", "\n\n"])
def test_a_map_of_movingai_is_read(ends: str, after: str) -> None:
    text = (ARENA + after).replace("\n", ends).encode()
    reading = read({"arena.map": text})
    assert reading.request == {"grid": ARENA_GRID, "cell_size": 1}
    costs = csv(np.ones((3, 5), int))
    assert len(read({"arena.map": text, "a.csv": costs}).request["cost_layers"]) == 1


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (ARENA.replace("height 3", "height 4"), "must have 4 rows, as its header says, got 3"),
        (ARENA.replace("height 3", "height 2"), "must have 2 rows, as its header says, got 3"),
        (ARENA.replace("TWO..", "TWO."), "row 3 must have 5 cells, as its header says, got 4"),
        (ARENA.replace("S", "x"), "row 2 must have cells .GS@OTW, got 'x'"),
        (ARENA.replace("width 5", "width 999999999"), "must have 1 to 1000000 cells"),
        (ARENA.replace("width 5", "width 0"), "must have 1 to 1000000 cells"),
    ],
)
def test_a_map_of_movingai_that_is_wrong_is_refused(text: str, said: str) -> None:
    with pytest.raises(UnreadableFile, match=said):
        read({"arena.map": text.encode()})
