"""Files become requests. Any other file is refused with a sentence that names it."""

import io
import os
import sys
from collections.abc import Callable
from pathlib import Path
from queue import Queue
from threading import Thread, Timer
from typing import Any

import numpy as np
import pytest
from paretour import Client, Plan
from typer.testing import CliRunner

from service.cli.commands import app
from service.cli.errors import UnreadableFile, UsageError
from service.cli.inputs import read_layer, read_object, read_request
from tests.client.test_robots import REQUEST as ROBOTS
from tests.helpers.fleet_requests import fleet_request
from tests.helpers.tsplib_files import EUCLIDEAN, EXPLICIT


def written(folder: Path, *texts: tuple[str, str]) -> list[Path]:
    paths = [folder / name for name, _ in texts]
    for path, (_, text) in zip(paths, texts, strict=True):
        path.write_text(text)
    return paths


def read_map(path: Path) -> tuple[dict[str, Any], bytes | None]:
    found = read_request([path], "coverage")
    return found.request, found.picture


@pytest.mark.parametrize(
    "text",
    ["1,2,3,4\n5,6,7,8.5\n", "x1;y1;x2;y2\n1;2;3;4\n\n5;6;7;8.5", "1\t2\t3\t4\r\n5\t6\t7\t8.5\r\n"],
)
def test_four_columns_are_coordinates(tmp_path: Path, text: str) -> None:
    files = written(tmp_path, ("a.csv", text))
    assert read_request(files, "front")[0] == {"coordinates": [[1, 2, 3, 4], [5, 6, 7, 8.5]]}


@pytest.mark.parametrize(
    "text",
    ["1,2,3,4,5,6\n7,8,9,10,11,12.5\n", "x1,y1,x2,y2,x3,y3\n1,2,3,4,5,6\n7,8,9,10,11,12.5\n"],
)
def test_six_columns_are_three_planes(tmp_path: Path, text: str) -> None:
    files = written(tmp_path, ("a.csv", text))
    rows = [[1, 2, 3, 4, 5, 6], [7, 8, 9, 10, 11, 12.5]]
    assert read_request(files, "front")[0] == {"coordinates": rows}


def test_eight_columns_with_ids_are_four_objectives(tmp_path: Path) -> None:
    files = written(
        tmp_path, ("a.csv", "id,x,y,u,v,x2,y2,x3,y3\na,1,2,3,4,5,6,7,8\nb,0,0,0,0,0,0,0,0\n")
    )
    request = read_request(files, "front")[0]
    assert request["stops"] == [{"id": "a"}, {"id": "b"}]
    planes = [objective["coordinates"][0] for objective in request["objectives"]]
    assert planes == [[1, 2], [3, 4], [5, 6], [7, 8]]


def test_each_column_of_costs_is_an_objective(tmp_path: Path) -> None:
    text = "id,lon,lat,risk,co2,noise\na,24.9,60.1,1,2,3\nb,24.8,60.2,3,2,1\nc,24.7,60,1,1,1\n"
    request = read_request(written(tmp_path, ("a.csv", text)), "front")[0]
    names = [objective["name"] for objective in request["objectives"]]
    assert names == ["distance", "risk", "co2", "noise"]
    ways = np.array([objective["matrix"] for objective in request["objectives"][1:]])
    # Between a and b a metre costs the mean of both ends, which is 2 in each column.
    np.testing.assert_allclose(ways[:, 0, 1], ways[0, 0, 1])
    assert ways[0, 0, 1] > ways[0, 0, 2] > 0


@pytest.mark.parametrize(
    ("texts", "sentence"),
    [
        (["a,b,c,d,e,f\n1,2,3,4,5,6\n"], "in 4, 6 or 8 columns of numbers"),
        (["1,2,3,4,5\n"], "in 4, 6 or 8 columns of numbers"),
        (["id,lon,lat,risk,co2,noise,cost\na,24.9,60.1,1,2,3,4\n"], "at most 3 columns of costs"),
        (["1,2\n3,4\n5,6\n"] * 5, "one for each of two to 4 objectives, got 5"),
        (
            ["1,2\n3,4\n5,6\n", "1,2\n3,4\n5,6\n", "1,2\n3,4\n5,6\n7,8\n"],
            "the same number of stops",
        ),
        (
            ["id,x,y\na,1,2\nb,1,3\nc,1,1\n", "1,2\n3,4\n5,6\n", "id,x,y\na,1,2\nc,1,3\nb,1,1\n"],
            "the same ids",
        ),
    ],
)
def test_files_that_make_no_front_of_several_objectives_are_refused(
    tmp_path: Path, texts: list[str], sentence: str
) -> None:
    files = written(tmp_path, *((f"{at}.csv", text) for at, text in enumerate(texts)))
    with pytest.raises(UnreadableFile, match=sentence):
        read_request(files, "front")


def test_three_files_are_an_objective_each(tmp_path: Path) -> None:
    planes = written(tmp_path, *((f"{name}.csv", "1,2\n5,6\n0,0\n") for name in "abc"))
    rows = [[1, 2] * 3, [5, 6] * 3, [0, 0] * 3]
    assert read_request(planes, "front")[0] == {"coordinates": rows}
    kro = written(tmp_path, *((f"{name}.tsp", EUCLIDEAN) for name in "abc"))
    assert len(read_request(kro, "front")[0]["matrices"]) == 3
    mixed = [planes[0], kro[0], planes[1]]
    names = [each["name"] for each in read_request(mixed, "front")[0]["objectives"]]
    assert names == ["first length", "second length", "third length"]


def test_two_columns_in_two_files_are_a_plane_each(tmp_path: Path) -> None:
    files = written(tmp_path, ("a.csv", "1,2\n5,6\n0,0\n"), ("b.csv", "x,y\n3,4\n7,8\n0,0\n"))
    expected = [[1, 2, 3, 4], [5, 6, 7, 8], [0, 0, 0, 0]]
    assert read_request(files, "front")[0] == {"coordinates": expected}


def test_square_tables_in_two_files_are_matrices(tmp_path: Path) -> None:
    rows = "0,1,2\n3,0,4\n5,6,0\n"
    matrix = [[0, 1, 2], [3, 0, 4], [5, 6, 0]]
    files = written(tmp_path, ("a.csv", rows), ("b.csv", rows))
    assert read_request(files, "front")[0]["matrices"].tolist() == [matrix, matrix]


def test_json_is_a_request_or_its_coordinates(tmp_path: Path) -> None:
    request = '{"coordinates": [[1, 2, 3, 4]], "seed": 3}'
    whole, alone = written(tmp_path, ("a.json", request), ("b.json", "[[1, 2, 3, 4]]"))
    assert read_request([whole], "front")[:2] == ({"coordinates": [[1, 2, 3, 4]], "seed": 3}, None)
    assert read_request([alone], "front")[0] == {"coordinates": [[1, 2, 3, 4]]}


def test_files_of_tsplib_are_matrices_with_euclidean_distances_rounded(tmp_path: Path) -> None:
    files = written(tmp_path, ("a.tsp", EUCLIDEAN), ("b.atsp", EXPLICIT))
    rounded = [[0, 3, 1], [3, 0, 3], [1, 3, 0]]
    explicit = [[0, 1, 2], [3, 0, 4], [5, 6, 0]]
    assert read_request(files, "front")[0]["matrices"].tolist() == [rounded, explicit]


def test_files_of_tsplib_are_planes_where_that_is_asked_for(tmp_path: Path) -> None:
    files = written(tmp_path, ("a.tsp", EUCLIDEAN), ("b.tsp", EUCLIDEAN))
    expected = [[0, 0, 0, 0], [3.4, 0, 3.4, 0], [0, 0.5, 0, 0.5]]
    assert read_request(files, "front", unrounded=True)[0] == {"coordinates": expected}


def test_a_map_is_read_by_its_suffix(tmp_path: Path) -> None:
    pgm = b"P5 1 1 255\n\xfe"
    (tmp_path / "map.pgm").write_bytes(pgm)
    (tmp_path / "map.yaml").write_text(
        "{image: map.pgm, resolution: 1, origin: [0, 0, 0], negate: 0, occupied_thresh: 0.65,"
        " free_thresh: 0.196}"
    )
    assert read_map(tmp_path / "map.pgm") == ({}, pgm)
    members, picture = read_map(tmp_path / "map.yaml")
    assert (members["cell_size"], members["free_thresh"], picture) == (1.0, 0.196, pgm)
    (tmp_path / "broken.yml").write_text("1")
    with pytest.raises(UsageError, match=r"broken\.yml: a map.yaml must be keys with values"):
        read_map(tmp_path / "broken.yml")


WRONG = [
    ("a.csv", "", "must have a row for each stop, got none"),
    ("a.csv", "a,b,c,d\n", "must have a row for each stop below its heading"),
    ("a.csv", "1,2,3\n", "got columns of numbers, '1', '2', '3', which may be anything"),
    ("a.csv", "1,2,3,4\n1,2,3\n", "row 2 must have 4 fields, as the first row, got 3"),
    ("a.csv", "1,2,3,4\n1,2,x,4\n", "row 2, column '3' must be a number, got 'x'"),
    ("a.csv", "1,2,3,nan\n", "row 1, column '4' must be a number, got 'nan'"),
    ("a.json", "{", "must be JSON"),
    ("a.json", "[" * 100_000, "must be JSON"),
    ("a.csv", '1,"2', "must be CSV: unexpected end of data"),
    ("a.csv", "1,5;2;3;4\n1.23,5;2;3;4\n", "row 2, column '1' must be a number, got '1.23,5'"),
    ("a.csv", "id,1,2,3\n1,2,3,4\n", "got columns of numbers, '1', '2', '3'"),
    (
        "a.csv",
        "a,1,2,3,4\nb,1,2,3,4\na,5,6,7,8\n",
        "row 3, column '1' must be an id that no other row has",
    ),
    ("a.csv", "id,1,1,1,1\n ,1,2,3,4\n", "row 2, column 'id' must be an id, got none"),
    ("a.json", "3", "must be a request, an object, or its coordinates, a list"),
    ("a.tsp", EUCLIDEAN, "one objective: name another"),
]


@pytest.mark.parametrize(("name", "text", "sentence"), WRONG)
def test_a_file_that_cannot_be_read_is_named(
    tmp_path: Path, name: str, text: str, sentence: str
) -> None:
    files = written(tmp_path, (name, text))
    with pytest.raises(UnreadableFile) as error:
        read_request(files, "front")
    assert str(error.value).startswith(f"{files[0]}: ")
    assert sentence in str(error.value)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"\xff\xfe1")
    with pytest.raises(UnreadableFile, match=r"a\.csv"):
        read_request([path], "front")


WRONG_PAIRS = [
    ("a.tsp", "", "b.tsp", EXPLICIT, "a.tsp: must have a row for each stop"),
    ("a.csv", "1,2\n3,4\n5,6\n", "b.csv", "1,2\n3,4\n", "the same number of stops, got 3 of"),
    ("a.csv", "1,2,3\n", "b.csv", "1,2\n", "got 1 row of 3 columns"),
]


@pytest.mark.parametrize(("first", "text", "second", "other", "sentence"), WRONG_PAIRS)
def test_two_files_that_do_not_go_together_are_refused(
    tmp_path: Path, first: str, text: str, second: str, other: str, sentence: str
) -> None:
    with pytest.raises(UnreadableFile) as error:
        read_request(written(tmp_path, (first, text), (second, other)), "front")
    assert sentence in str(error.value)


def test_numbers_may_have_decimal_commas(tmp_path: Path) -> None:
    files = written(tmp_path, ("a.csv", "x1;y1;x2;y2\n1,5;-2;3e1;4\n,5;6;7.25;8\n"))
    assert read_request(files, "front")[0] == {"coordinates": [[1.5, -2, 30, 4], [0.5, 6, 7.25, 8]]}


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("id,x1,y1,x2,y2\ndepot,1,2,3,4\nb 2,5,6,7,8\n", ("depot", "b 2")),
        ("ID;x1;y1;x2;y2\n17;1,0;2;3;4\n18;5;6;7;8\n", ("17", "18")),
        ("depot,1,2,3,4\n2,5,6,7,8\n", ("depot", "2")),
        ("1,2,3,4\n5,6,7,8\n", None),
    ],
)
def test_a_first_column_may_hold_ids(
    tmp_path: Path, text: str, ids: tuple[str, ...] | None
) -> None:
    request, found = read_request(written(tmp_path, ("a.csv", text)), "front")[:2]
    assert found == ids
    planes = [[[1, 2], [5, 6]], [[3, 4], [7, 8]]]
    if ids is None:
        assert request == {"coordinates": [[1, 2, 3, 4], [5, 6, 7, 8]]}
    else:
        assert [each["coordinates"] for each in request["objectives"]] == planes


def test_the_ids_of_two_files_are_the_same(tmp_path: Path) -> None:
    named, other, plain = "id,a,b\na,0,1\nb,2,0\n", "id,a,b\nb,0,1\na,2,0\n", "0,1\n2,0\n"
    files = written(tmp_path, ("a.csv", named), ("b.csv", plain), ("c.csv", other))
    assert read_request([files[1], files[0]], "front")[1] == ("a", "b")
    with pytest.raises(UnreadableFile, match="the same ids, in the same order"):
        read_request([files[0], files[2]], "front")


CITIES = [[0, 0, 1, 1], [3, 1, 2, 5], [1, 4, 5, 2], [4, 4, 1, 3]]


class Piped:
    """Standard input with these bytes in it."""

    def __init__(self, data: bytes) -> None:
        self.buffer = io.BytesIO(data)


@pytest.mark.parametrize(
    "data", [b' {"coordinates": [[1, 2, 3, 4]]}', b"[[1, 2, 3, 4]]", b"x1;y1;x2;y2\n1;2;3;4\n"]
)
def test_a_file_may_be_standard_input(data: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", Piped(data))
    assert read_request([Path("-")], "front")[0] == {"coordinates": [[1, 2, 3, 4]]}


def test_one_of_several_files_may_be_standard_input(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    [file] = written(tmp_path, ("a.csv", "1,2\n3,4\n5,6\n"))
    monkeypatch.setattr(sys, "stdin", Piped(b"0,0\n1,1\n2,2\n"))
    expected = [[1, 2, 0, 0], [3, 4, 1, 1], [5, 6, 2, 2]]
    assert read_request([file, Path("-")], "front")[0] == {"coordinates": expected}
    with pytest.raises(UsageError, match="only one of the files can be standard input"):
        read_request([Path("-"), Path("-")], "front")


PIPED: dict[tuple[str, ...], Any] = {
    ("front", "-"): {"coordinates": CITIES},
    ("tour", "-", "--knee"): {"coordinates": CITIES},
    ("fleet", "-", "--csv"): fleet_request(),
    ("coverage", "-", "--csv"): ROBOTS,
    ("replan", "FRONT", "-", "--csv"): {"done": [0, 1]},
}


@pytest.mark.parametrize("arguments", PIPED)
def test_every_command_has_a_service_plan_what_is_piped_into_it(
    arguments: tuple[str, ...], url: str
) -> None:
    with Client(url) as client:
        front = client.front(coordinates=CITIES, time_limit=0.1).id
    command = [front if each == "FRONT" else each for each in arguments]
    piped = Plan("/", PIPED[arguments] | {"time_limit": 0.1}).json
    ended = CliRunner().invoke(app, [*command, "--url", url], input=piped)
    assert ended.exit_code == 0, ended.stderr
    assert ended.stdout


def test_a_map_and_its_costs_are_not_both_standard_input() -> None:
    ended = CliRunner().invoke(app, ["coverage", "-", "--cost-layer", "-"], input=b"P5 1 1 255 a")
    assert ended.exit_code == 2
    assert "only one of the files can be standard input" in ended.stderr


def test_standard_input_is_named_where_it_cannot_be_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", Piped(b"1,2,3\n"))
    with pytest.raises(UnreadableFile, match="standard input: must say where each stop is"):
        read_request([Path("-")], "front")


def test_a_map_may_be_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", Piped(b"\x89PNG..."))
    assert read_map(Path("-")) == ({}, b"\x89PNG...")
    monkeypatch.setattr(sys, "stdin", Piped(b'{"grid": [[0]]}'))
    assert read_map(Path("-")) == ({"grid": [[0]]}, None)


def test_a_map_is_a_request_or_a_picture(tmp_path: Path) -> None:
    written(tmp_path, ("map.json", '{"grid": [[0]]}'), ("map.png", "PNG"))
    assert read_map(tmp_path / "map.json") == ({"grid": [[0]]}, None)
    assert read_map(tmp_path / "map.png") == ({}, b"PNG")


def refusal(read: Callable[[], object]) -> str:
    """The sentence that a call is refused with, in a thread that holds up nobody if it waits."""
    said: Queue[str] = Queue()

    def run() -> None:
        with pytest.raises((UnreadableFile, UsageError)) as refused:
            read()
        said.put(str(refused.value))

    Thread(target=run, daemon=True).start()
    return said.get(timeout=60)


READERS: list[Callable[[Path], object]] = [
    read_layer,
    read_object,
    read_map,
    lambda path: read_request([path], "front"),
    lambda path: read_request([path], "fleet"),
    lambda path: read_request([path.with_name("a.csv"), path], "front"),
]


@pytest.mark.parametrize("read", READERS)
def test_a_pipe_is_read_only_where_a_program_writes_into_it(
    tmp_path: Path, read: Callable[[Path], object]
) -> None:
    written(tmp_path, ("a.csv", "1,2\n3,4\n5,6\n"))
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    demand = "must be a file, or a pipe that a program writes into"
    assert refusal(lambda: read(pipe)) == f"{pipe}: {demand}"
    descriptor = os.open(pipe, os.O_RDWR)  # what a program has open that writes nothing yet
    writer = Timer(0.2, lambda: (os.write(descriptor, b"{ no table"), os.close(descriptor)))
    writer.start()
    assert demand not in refusal(lambda: read(pipe))
    writer.join()


def test_costs_on_a_map_are_a_table(tmp_path: Path) -> None:
    [file] = written(tmp_path, ("people.csv", "1,2,3\n4,5,6\n"))
    assert read_layer(file).tolist() == [[1, 2, 3], [4, 5, 6]]
