"""Errors end the command with a sentence and an exit code."""

from pathlib import Path

import httpx
import pytest
import typer
from paretour import Refused, UnexpectedAnswer

from service.cli.errors import UnreadableFile, UsageError, exit_on_error
from service.cli.output import end_of_search
from service.errors.faults import Fault
from tests.helpers.command import EXAMPLE, paretour


def refused(status: int) -> Refused:
    return Refused({"status": status, "code": "a-code", "detail": "a sentence"})


REMEDY = {"code": "more-time", "detail": "search for 1 s", "patch": [], "values": {}}
HELPED = {"errors": [{"detail": "a sentence", "remedies": [REMEDY]}], **refused(422).document}
HELP = "Each of these changes to the request alone helps, as was tried:\n- search for 1 s\n"
EXITS = [
    (Refused(HELPED), 2, f"paretour: a sentence (a-code)\n{HELP}"),
    (UsageError("a sentence", Refused(HELPED).remedies), 2, f"paretour: a sentence\n{HELP}"),
    (UsageError("a sentence"), 2, "paretour: a sentence\n"),
    (UnreadableFile(Fault("a-code", said="a.csv: a sentence")), 2, "paretour: a.csv: a sentence\n"),
    (FileNotFoundError(2, "No such file", "a.csv"), 2, "paretour: a.csv: No such file\n"),
    (refused(422), 2, "paretour: a sentence (a-code)\n"),
    (refused(401), 3, "paretour: a sentence (a-code)\n"),
    (refused(429), 3, "paretour: a sentence (a-code)\n"),
    (refused(503), 3, "paretour: a sentence (a-code)\n"),
    (UnexpectedAnswer("a sentence"), 3, "paretour: the service's answer is wrong: a sentence\n"),
    (httpx.ConnectError("refused"), 3, "paretour: the service does not answer: refused\n"),
]


@pytest.mark.parametrize(("error", "code", "sentence"), EXITS)
def test_an_expected_error_is_a_sentence_and_an_exit_code(
    error: Exception, code: int, sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(typer.Exit) as ended, exit_on_error():
        raise error
    assert ended.value.exit_code == code
    assert capsys.readouterr() == ("", sentence)


def test_a_fault_of_the_program_stays_an_exception() -> None:
    with pytest.raises(KeyError), exit_on_error():
        raise KeyError("city")


def test_an_end_that_only_a_later_service_knows_is_told() -> None:
    assert end_of_search("bore\x1bdom") == r"ended: 'bore\x1bdom'"


def test_what_the_service_refuses_ends_with_2(url: str) -> None:
    ended = paretour("front", EXAMPLE, "--start", 61, "--url", url)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "start must be a city, 0 to 60, got 61" in ended.stderr


def test_a_service_that_is_not_there_ends_with_3(cities: Path) -> None:
    ended = paretour("front", cities, "--url", "http://127.0.0.1:1")
    assert (ended.returncode, ended.stdout) == (3, "")
    assert "does not answer" in ended.stderr
