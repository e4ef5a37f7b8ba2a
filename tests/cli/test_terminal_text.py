"""Text of files and servers reaches a terminal without what a terminal would obey."""

import csv
import io
import json
import logging
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import httpx
import pytest
from paretour import Objective
from typer.testing import CliRunner

from service.cli import backends
from service.cli.commands import app
from service.cli.data import csv_text, print_csv, print_data
from service.cli.output import labels_of, lengths_as_text
from service.errors.printable import printable
from service.telemetry import PlainFormatter

HOSTILE = "\x1b]0;owned\x07\x1b[31mred\x9b2J\u202eabc\u2028[bold]\r\n=end"
OBEYED = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\u2028\u2029]")
CITIES = [
    {"id": f"{HOSTILE}{i}", "location": [24.9 + i / 1000, 60.1 + i * i % 7 / 1000]}
    for i in range(6)
]
REQUEST = {
    "stops": CITIES,
    "objectives": [
        {"name": "way", "from": "great_circle"},
        {"name": "risk", "coordinates": [[i, i * 3 % 5] for i in range(6)]},
    ],
    "time_limit": 0,
}


def test_what_is_printed_has_no_character_that_is_obeyed() -> None:
    shown = printable(HOSTILE)
    assert OBEYED.search(shown) is None
    assert "\n" not in shown
    assert printable("München, Saint-Étienne, 東京\u00a0駅") == "München, Saint-Étienne, 東京 駅"


def test_a_field_with_a_carriage_return_is_quoted() -> None:
    assert csv_text([("a\rb", "c d", 1)]) == '"a\rb",c d,1'
    assert csv_text([("a b", 'c"d')], delimiter=" ") == '"a b" "c""d"'


@pytest.mark.parametrize("content", [b"\xff\x1b[31m", HOSTILE.encode(), b'{"\x1b[31m": 1}'])
def test_a_file_that_cannot_be_read_is_named_in_one_harmless_line(
    tmp_path: Path, content: bytes
) -> None:
    file = tmp_path / "orders\x1b[31m.csv"
    file.write_bytes(content)
    result = CliRunner().invoke(app, ["front", str(file)])
    assert result.exit_code == 2
    assert OBEYED.search(result.stderr.rstrip("\n")) is None
    assert len(result.stderr.strip().splitlines()) == 1


@pytest.mark.parametrize("name", ["a" * 5000, "no\x1b[31mne.csv"])
def test_a_file_that_cannot_be_opened_is_one_harmless_line(name: str) -> None:
    result = CliRunner().invoke(app, ["front", name])
    assert result.exit_code == 2
    assert "Traceback" not in result.output
    assert "\x1b[31m" not in result.stderr


def test_what_a_service_says_is_printed_without_its_escape_sequences(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    problem = {"status": 422, "code": "invalid-request", "detail": HOSTILE, "request_id": HOSTILE}

    def answer(_: httpx.Request) -> httpx.Response:
        headers = {"Content-Type": "application/problem+json"}
        return httpx.Response(422, content=json.dumps(problem), headers=headers)

    real = backends.Client
    monkeypatch.setattr(
        backends,
        "Client",
        lambda url, **more: real(url, transport=httpx.MockTransport(answer), **more),
    )
    file = tmp_path / "request.json"
    file.write_text(json.dumps(REQUEST))
    result = CliRunner().invoke(app, ["front", str(file), "--url", "http://service"])
    assert result.exit_code == 2
    assert OBEYED.search(result.stderr.rstrip("\n")) is None


class Terminal(io.StringIO):
    """A stream that says that it is a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("stream", [Terminal(), io.StringIO()])
def test_data_is_harmless_on_a_terminal_and_elsewhere_as_it_is(
    stream: io.StringIO, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdout", stream)
    print_data("a,\x1b[31mred\nb,\u202ec")
    expected = "a,?[31mred\nb,?c\n" if stream.isatty() else "a,\x1b[31mred\nb,\u202ec\n"
    assert stream.getvalue() == expected


def test_a_row_with_line_breaks_in_it_is_one_line_on_a_terminal_and_elsewhere_as_it_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rows = [("a\nb", 1.5, csv_text([("c\r\n=end", "d")], delimiter=" ")), ("e", 2, "f")]
    for stream in (Terminal(), io.StringIO()):
        monkeypatch.setattr("sys.stdout", stream)
        print_csv(rows)
        text = stream.getvalue()
        if stream.isatty():
            assert len(text.splitlines()) == len(rows)
            assert OBEYED.search(text) is None
        else:
            assert [row[0] for row in csv.reader(io.StringIO(text, newline=""))] == ["a\nb", "e"]


def test_names_that_a_service_gives_are_labels_without_escape_sequences() -> None:
    objectives = tuple(Objective(name=f"{HOSTILE}{m}", unit="\x1b[32mm") for m in range(2))
    labels = [each.label for each in objectives]
    front: Any = SimpleNamespace(objectives=objectives, labels=labels)
    assert not any(OBEYED.search(label) for label in labels_of(front))
    assert OBEYED.search(lengths_as_text(front, (1.0, 2.0))) is None


def test_a_plain_line_of_the_log_holds_no_escape_sequence() -> None:
    record = logging.makeLogRecord({"msg": HOSTILE, "path": HOSTILE})
    line = PlainFormatter("%(message)s").format(record)
    assert OBEYED.search(line.replace("\n", "")) is None
