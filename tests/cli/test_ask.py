"""The command `paretour ask`: picks that are given, a terminal, and what it refuses."""

import json
import os
import pty
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.helpers.command import COMMAND, ROOT, paretour
from tests.helpers.fleet_requests import fleet_request
from tests.helpers.several_plans import with_several_plans


@pytest.fixture(scope="module")
def front(url: str) -> dict[str, Any]:
    """A front of plans that the service has."""
    return with_several_plans(
        lambda: dict(httpx.post(f"{url}/fleet", json=fleet_request(), timeout=300).json())
    )


@pytest.fixture
def file(front: dict[str, Any], tmp_path: Path) -> Path:
    path = tmp_path / "front.json"
    path.write_text(json.dumps(front))
    return path


def questions(url: str, front: str) -> Iterator[tuple[list[int], dict[str, Any]]]:
    """The questions of the service where the last option is always picked, to the end."""
    picks: list[int] = []
    left = 1
    while left:
        query = {"picks": ",".join(map(str, picks))}
        answer = httpx.get(f"{url}/front/{front}/questions", params=query).json()
        yield picks, answer
        left = answer["left"]
        picks = [*picks, len(answer["options"]) - 1]


def test_it_answers_as_the_service_does_from_a_file_and_by_url(
    url: str, front: dict[str, Any], file: Path
) -> None:
    for picks, answer in questions(url, front["id"]):
        given = ("--json", "--picks", ",".join(map(str, picks)))
        of_file = paretour("ask", file, *given)
        assert of_file.returncode == 0, of_file.stderr
        assert json.loads(of_file.stdout) == answer
    by_url = paretour("ask", front["id"], "--url", url, *given)
    assert json.loads(by_url.stdout) == answer
    assert answer["plan"] == front["front"][answer["number"]]
    chosen = paretour("ask", file, *given[1:])
    routes = [row.split(",")[-1].split() for row in chosen.stdout.splitlines()[1:]]
    assert routes == [route["stops"] for route in answer["plan"]["routes"]]
    assert f"plan {answer['number']}: " in chosen.stderr


def test_at_a_terminal_it_asks_until_a_plan_is_chosen(
    url: str, front: dict[str, Any], file: Path
) -> None:
    *_, (picks, end) = questions(url, front["id"])
    typed = [str(picks[0]), "b", "7", *map(str, picks)]  # back once, and no such option once
    ours, theirs = pty.openpty()
    os.write(ours, "".join(f"{each}\n" for each in typed).encode())
    ended = subprocess.run(
        [*COMMAND, "ask", str(file)], cwd=ROOT, stdin=theirs, capture_output=True, text=True
    )
    assert ended.returncode == 0, ended.stderr
    assert f"Question {len(picks)} of 3" in ended.stderr
    assert f"plan {end['number']}: " in ended.stderr
    assert f"--picks {','.join(map(str, picks))}" in ended.stderr


@pytest.mark.parametrize(
    ("content", "options", "sentence"),
    [
        (None, (), "a pick is needed, 0 to "),
        (None, ("--picks", "9"), "--picks must each be the number of an option, here from 0 to "),
        (None, ("--picks", "a"), "--picks must be numbers of options with commas between"),
        ("1,2,3,4\n", (), "must be a front, as `paretour front FILE --json` prints it"),
    ],
)
def test_without_a_terminal_what_is_missing_or_wrong_is_said(
    file: Path, content: str | None, options: tuple[str, ...], sentence: str
) -> None:
    if content is not None:
        file.write_text(content)
    ended = paretour("ask", file, *options)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert sentence in " ".join(ended.stderr.split())
