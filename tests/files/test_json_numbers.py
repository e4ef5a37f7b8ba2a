"""Numbers and texts of JSON files: what is refused over HTTP is refused in files."""

import json

import pytest

from service.errors import Refusal
from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, UnreadableFile
from service.kinds.parsing import parse_task
from service.requests.task import TaskSource
from tests.files.test_examples import ACTORS
from tests.helpers.serving import LIMITS

LEGS = '{"matrices": [[[0, %s], [1, 0]], [[0, 1], [1, 0]]]}'
NO_JSON = [
    ("NaN", "NaN is not JSON: write null where there is no way"),
    ("Infinity", "Infinity is not JSON"),
    ("-Infinity", "-Infinity is not JSON"),
    ("nan", "must be JSON"),
    ("1e999", "must have numbers that are finite, got '1e999'"),
    ("-1.5E+400", "must have numbers that are finite, got '-1.5E+400'"),
    ('"\\ud800"', "half a character"),
    ("01", "must be JSON"),
]


@pytest.mark.parametrize(("leg", "sentence"), NO_JSON)
def test_what_is_no_number_of_json_is_refused_as_over_http(leg: str, sentence: str) -> None:
    body = (LEGS % leg).encode()
    with pytest.raises(UnreadableFile) as refused:
        read_files([NamedFile("a.json", body)], Bounds())
    assert sentence in str(refused.value)
    with pytest.raises(Refusal):
        parse_task(TaskSource("front", body), LIMITS, ACTORS)


@pytest.mark.parametrize("leg", ["null", "1e300", "1e-999", "1E5"])
def test_other_numbers_and_null_are_read(leg: str) -> None:
    request = read_files([NamedFile("a.json", (LEGS % leg).encode())], Bounds()).request
    assert request["matrices"][0][0][1] == json.loads(leg)


@pytest.mark.parametrize("text", ["1e999", "NaN", "Infinity,"])
def test_texts_are_no_numbers(text: str) -> None:
    rows = json.dumps([{"id": text, "lat": 60.1, "lon": 24.9}, {"id": "b", "lat": 60, "lon": 24}])
    [first, _] = read_files([NamedFile("a.json", rows.encode())], Bounds()).request["stops"]
    assert first["id"] == text
