"""Files become requests, and what is no such file is refused with a sentence that names it."""

from pathlib import Path

import pytest

from service.cli.errors import UnreadableFile
from service.cli.files import read_layer, read_map, read_request
from tests.helpers.tsplib_files import EUCLIDEAN, EXPLICIT


def written(folder: Path, *texts: tuple[str, str]) -> list[Path]:
    paths = [folder / name for name, _ in texts]
    for path, (_, text) in zip(paths, texts, strict=True):
        path.write_text(text)
    return paths


@pytest.mark.parametrize(
    "text",
    ["1,2,3,4\n5,6,7,8.5\n", "x1;y1;x2;y2\n1;2;3;4\n\n5;6;7;8.5", "1\t2\t3\t4\r\n5\t6\t7\t8.5\r\n"],
)
def test_four_columns_are_coordinates(tmp_path: Path, text: str) -> None:
    files = written(tmp_path, ("a.csv", text))
    assert read_request(files) == {"coordinates": [[1, 2, 3, 4], [5, 6, 7, 8.5]]}


def test_two_columns_in_two_files_are_a_plane_each(tmp_path: Path) -> None:
    files = written(tmp_path, ("a.csv", "1,2\n5,6\n0,0\n"), ("b.csv", "x,y\n3,4\n7,8\n0,0\n"))
    expected = [[1, 2, 3, 4], [5, 6, 7, 8], [0, 0, 0, 0]]
    assert read_request(files) == {"coordinates": expected}


def test_square_tables_in_two_files_are_matrices(tmp_path: Path) -> None:
    rows = "0,1,2\n3,0,4\n5,6,0\n"
    matrix = [[0, 1, 2], [3, 0, 4], [5, 6, 0]]
    files = written(tmp_path, ("a.csv", rows), ("b.csv", rows))
    assert read_request(files)["matrices"].tolist() == [matrix, matrix]


def test_json_is_a_request_or_its_coordinates(tmp_path: Path) -> None:
    request = '{"coordinates": [[1, 2, 3, 4]], "seed": 3}'
    whole, alone = written(tmp_path, ("a.json", request), ("b.json", "[[1, 2, 3, 4]]"))
    assert read_request([whole]) == {"coordinates": [[1, 2, 3, 4]], "seed": 3}
    assert read_request([alone]) == {"coordinates": [[1, 2, 3, 4]]}


def test_files_of_tsplib_are_matrices_with_euclidean_distances_rounded(tmp_path: Path) -> None:
    files = written(tmp_path, ("a.tsp", EUCLIDEAN), ("b.atsp", EXPLICIT))
    rounded = [[0, 3, 1], [3, 0, 3], [1, 3, 0]]
    explicit = [[0, 1, 2], [3, 0, 4], [5, 6, 0]]
    assert read_request(files)["matrices"].tolist() == [rounded, explicit]


def test_files_of_tsplib_are_planes_where_that_is_asked_for(tmp_path: Path) -> None:
    files = written(tmp_path, ("a.tsp", EUCLIDEAN), ("b.tsp", EUCLIDEAN))
    expected = [[0, 0, 0, 0], [3.4, 0, 3.4, 0], [0, 0.5, 0, 0.5]]
    assert read_request(files, unrounded=True) == {"coordinates": expected}


WRONG = [
    ("a.csv", "", "must have a row of numbers for each city, got none"),
    ("a.csv", "a,b,c,d\n", "must have a row of numbers"),
    ("a.csv", "1,2,3\n", "must have 4 columns, x and y in either plane, got 3"),
    ("a.csv", "1,2,3,4\n1,2,3\n", "line 2 must have 4 fields, as the first row, got 3"),
    ("a.csv", "1,2,3,4\n1,2,x,4\n", "line 2 must hold numbers, got 'x'"),
    ("a.csv", "1,2,3,nan\n", "line 1 must hold numbers, got 'nan'"),
    ("a.json", "{", "must be JSON"),
    ("a.json", "3", "must be a request, an object, or its coordinates, a list"),
    ("a.tsp", EUCLIDEAN, "one objective: name another"),
]


@pytest.mark.parametrize(("name", "text", "sentence"), WRONG)
def test_a_file_that_cannot_be_read_is_named(
    tmp_path: Path, name: str, text: str, sentence: str
) -> None:
    files = written(tmp_path, (name, text))
    with pytest.raises(UnreadableFile) as error:
        read_request(files)
    assert str(error.value).startswith(f"{files[0]}: ")
    assert sentence in str(error.value)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"\xff\xfe1")
    with pytest.raises(UnreadableFile, match=r"a\.csv"):
        read_request([path])


WRONG_PAIRS = [
    ("a.tsp", "", "b.tsp", EXPLICIT, "a.tsp: EDGE_WEIGHT_TYPE must be EUC_2D"),
    ("a.csv", "1,2\n3,4\n5,6\n", "b.csv", "1,2\n3,4\n", "got 3x2 and 2x2"),
    ("a.csv", "1,2,3\n", "b.csv", "1,2\n", "must have 2 columns, x and y, or as many as rows"),
]


@pytest.mark.parametrize(("first", "text", "second", "other", "sentence"), WRONG_PAIRS)
def test_two_files_that_do_not_go_together_are_refused(
    tmp_path: Path, first: str, text: str, second: str, other: str, sentence: str
) -> None:
    with pytest.raises(UnreadableFile) as error:
        read_request(written(tmp_path, (first, text), (second, other)))
    assert sentence in str(error.value)


def test_a_map_is_a_request_or_a_picture(tmp_path: Path) -> None:
    written(tmp_path, ("map.json", '{"grid": [[0]]}'), ("map.png", "PNG"))
    assert read_map(tmp_path / "map.json") == ({"grid": [[0]]}, None)
    assert read_map(tmp_path / "map.png") == ({}, b"PNG")


def test_costs_on_a_map_are_a_table(tmp_path: Path) -> None:
    [file] = written(tmp_path, ("people.csv", "1,2,3\n4,5,6\n"))
    assert read_layer(file).tolist() == [[1, 2, 3], [4, 5, 6]]
