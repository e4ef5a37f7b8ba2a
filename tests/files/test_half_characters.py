"""Half a character (a lone surrogate) in JSON is refused: nothing can write it again."""

import json

import pytest

from service.errors import Refusal
from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, UnreadableFile
from service.files.upload import Upload, read_upload
from tests.helpers.serving import LIMITS

HALF = r"\ud800"
POINT = '"geometry":{"type":"Point","coordinates":[24,60]}'
FILES = {
    "request": '{"stops":[{"id":"a"}],"%s":1}',
    "id of a request": '{"stops":[{"id":"%s"},{"id":"b"}],"objectives":[]}',
    "geojson": '{"type":"Feature","properties":{"id":"%s"},' + POINT + "}",
    "property": '{"type":"Feature","properties":{"id":"a","%s":1},' + POINT + "}",
    "records": '[{"id":"%s","lat":60,"lon":24},{"id":"b","lat":61,"lon":24}]',
    "name of a column": '[{"id":"a","lat":60,"lon":24,"%s":"x"}]',
    "detail": '[{"id":"a","lat":60,"lon":24,"note":"%s"}]',
    "vroom": '{"vehicles":[{"id":1,"start":[24,60]}],"jobs":[{"id":"%s","location":[24,60]}]}',
    "skill": '{"vehicles":[{"id":1,"start":[24,60],"skills":["%s"]}],"jobs":[]}',
    "map": '{"grid":[[0,0]],"name":"%s"}',
}


@pytest.mark.parametrize("half", [HALF, r"\uDFFF", r"x\udc00\ud800", r"\uD83D!"])
@pytest.mark.parametrize("name", FILES)
def test_half_a_character_is_refused(name: str, half: str) -> None:
    file = NamedFile("a.json", (FILES[name] % half).encode())
    with pytest.raises(Refusal) as refused:
        read_upload(Upload([file], None), LIMITS, {})
    assert refused.value.status == 422
    assert "which is half a character" in refused.value.detail
    refused.value.detail.encode()


@pytest.mark.parametrize("text", ["\U0001f69a", "a\\ud8", "\\\\ud800", "ä"])
def test_whole_characters_are_read(text: str) -> None:
    record = {"id": "a", "lat": 60, "lon": 24, "note": text}
    data = json.dumps([record, {**record, "id": "b"}]).encode()
    reading = read_files([NamedFile("a.json", data)], Bounds(), wanted=None)
    assert reading.details[0].texts == [text, text]


@pytest.mark.parametrize(
    "data",
    [
        "id,lat,lon\n\ud800,60,24\nb,61,24\n".encode("utf-16", "surrogatepass"),
        b"PK\x03\x04\xed\xa0\x80",
    ],
)
def test_half_a_character_in_other_files_is_refused(data: bytes) -> None:
    with pytest.raises(UnreadableFile):
        read_files([NamedFile("a.csv", data)], Bounds(), wanted=None)


def test_a_name_of_a_file_may_have_half_a_character() -> None:
    file = NamedFile("caf\udce9.csv", b"id,lat,lon\na,60,24\nb,61,24\n")
    read_upload(Upload([file], None), LIMITS, {})
