"""The whole command with broken files and hostile answers: a sentence, and a harmless terminal."""

import copy
import io
import json
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from http import HTTPStatus
from pathlib import Path
from typing import Any, ClassVar

import httpx
import pytest
from paretour import Plan
from typer.main import get_command

from service.cli import backends, configuration
from service.cli.commands import app
from service.errors import Cancelled
from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, UnreadableFile
from service.library import local_planner
from tests.cli.test_terminal_text import REQUEST
from tests.client.test_robots import REQUEST as ROBOTS
from tests.client.test_unexpected_answers import answers_of
from tests.files.test_examples import ACTORS
from tests.files.test_examples import FOLDER as WHOLE
from tests.files.test_fuzz import FILES, broken, harmless
from tests.helpers.answers import events, progress, status
from tests.helpers.fleet_requests import fleet_request
from tests.helpers.sampled import few, tenth
from tests.helpers.serving import LIMITS

COUNT = tenth(1000)
COMMAND = get_command(app)
PLANNED = 130  # the exit code of a command that ends before there is a front
HOSTILE = "\x1b]0;owned\x07\x1b[31mred\x9b2J\u202eabc\u2028[bold]\r\n=end\x00\x7f{}%s$"


class Terminal(io.StringIO):
    """A stream that says that it is a terminal."""

    encoding = "utf-8"

    def isatty(self) -> bool:
        return True


class Screen:
    """A terminal of no colours, on which a command runs in this process."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self._patch = patch
        patch.setenv("TERM", "dumb")
        patch.setenv("COLUMNS", "400")

    def run(self, *arguments: object) -> tuple[int, str, str]:
        """Return the exit code of a command, and what it prints on either stream."""
        stdout, stderr = Terminal(), Terminal()
        with self._patch.context() as patch:
            patch.setattr("sys.stdout", stdout)
            patch.setattr("sys.stderr", stderr)
            with pytest.raises(SystemExit) as ended:
                COMMAND.main([*map(str, arguments)], prog_name="paretour")
        code = ended.value.code or 0
        assert isinstance(code, int)
        return code, stdout.getvalue(), stderr.getvalue()


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch) -> Screen:
    return Screen(monkeypatch)


class Planless:
    """A runner that plans nothing."""

    actors: ClassVar[dict[str, Any]] = {}
    limits, infos = LIMITS, ACTORS

    def run(self, *_: object) -> Any:
        raise Cancelled

    def terminate(self) -> None:
        """End nothing."""


@cache
def kind_of(name: str) -> str:
    """The kind of a whole example: a command, or `pair` of one that needs a second file."""
    if name.endswith(".yaml"):
        return "coverage"
    try:
        return read_files([NamedFile(name, FILES[name])], Bounds(), wanted=None).kind
    except UnreadableFile:
        return "pair"


def command(folder: Path, number: int) -> list[object]:
    """A command about a broken file, or about a broken one and another."""
    file = broken(number)
    path = folder / file.name
    path.write_bytes(file.data)
    (folder / "map.pgm").write_bytes(broken(number).data if number % 2 else FILES["map.pgm"])
    kind = kind_of(file.name)
    if kind == "coverage":
        of_a_map = ["coverage", path, "--spacing", 1, "--cell-size", 1]
        options = (["--cost-layer", path], ["--robot", "0,0", "--robot", "0.1,0"])
        return of_a_map + options[number % 2]
    vehicles = ["fleet", WHOLE / "fleet-stops.csv", path]
    if kind == "pair":
        return (["front", path, path], ["tour", WHOLE / "plane-a.csv", path, "--knee"], vehicles)[
            number % 3
        ]
    return [[kind, path], [kind, path, "--seed", 3], ["tour", path, "--start", "a"]][number % 3]


@pytest.fixture
def planless(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have the command plan nothing, and read its settings once."""
    settings = configuration.load_settings()
    monkeypatch.setattr(configuration, "load_settings", lambda: settings)
    monkeypatch.setattr(local_planner, "load_runner", lambda *_: Planless())
    monkeypatch.setattr(local_planner, "warm_up", lambda *_: None)


@pytest.mark.usefixtures("planless")
def test_a_broken_file_ends_the_whole_command_with_a_sentence(
    tmp_path: Path, screen: Screen
) -> None:
    ended: dict[int, int] = {}
    for number in range(COUNT):
        code, stdout, stderr = screen.run(*command(tmp_path, number))
        ended[code] = ended.get(code, 0) + 1
        assert stdout == "", number
        assert harmless(stderr), (number, stderr)
        assert "Traceback" not in stderr, number
    assert ended.keys() == {2, PLANNED}
    assert ended[PLANNED] > COUNT // 25


def places_of_texts(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The place of each text in a document of JSON."""
    if isinstance(value, str):
        yield path
    if isinstance(value, dict | list | tuple):
        for key, each in value.items() if isinstance(value, dict) else enumerate(value):
            yield from places_of_texts(each, (*path, key))


def with_hostile(document: Any, path: tuple[Any, ...]) -> Any:
    """A copy of a document with a hostile text at a place, which began as the one that is there."""
    changed = copy.deepcopy(document)
    at = changed
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] += HOSTILE
    return changed


def hostile_files() -> Iterator[tuple[str, bytes]]:
    """The names and bytes of files with one hostile text: of every JSON, and of a map.yaml."""
    requests: list[tuple[str, Any]] = [("fleet", fleet_request()), ("front", REQUEST)]
    names = [name for name in FILES if name.lower().endswith("json")]
    for name in names:
        with suppress(ValueError):
            requests.append((name, json.loads(FILES[name])))
    for name, document in requests:
        for path in places_of_texts(document):
            yield name, json.dumps(with_hostile(document, path)).encode()
    lines = FILES["map.yaml"].decode().splitlines()
    for at, line in enumerate(lines):
        changed = f"{line.partition(':')[0]}: {json.dumps(HOSTILE)}"
        yield "map.yaml", "\n".join([*lines[:at], changed, *lines[at + 1 :]]).encode()


@pytest.mark.usefixtures("planless")
def test_no_text_of_a_file_is_obeyed_by_a_terminal(tmp_path: Path, screen: Screen) -> None:
    shown = 0
    for name, content in hostile_files():
        (tmp_path / name).write_bytes(content)
        for kind in ("front", "fleet", "coverage"):
            code, stdout, stderr = screen.run(kind, tmp_path / name)
            assert code in (2, PLANNED), (name, stderr)
            assert stdout == ""
            assert harmless(stderr), (name, content, stderr)
            shown += "owned" in stderr
    assert shown > 20


class Service:
    """What a service answers to a command: a job, its events, and its front."""

    def __init__(self, document: Any, job: Any, stream: Any, code: int = 200) -> None:
        self._document = document
        self._job = job
        self._stream = stream
        self._code = code

    def __call__(self, request: httpx.Request) -> httpx.Response:
        if request.url.path.endswith("/events"):
            stream, self._stream = self._stream, STREAM  # of a wrong end, the job goes on
            return events(*stream)
        if request.method == "POST":
            return httpx.Response(202, json=self._job)
        kind = "json" if self._code == HTTPStatus.OK else "problem+json"
        headers = {"Content-Type": f"application/{kind}"}
        return httpx.Response(self._code, content=json.dumps(self._document), headers=headers)


COMMANDS = {
    "front": [["front"], ["front", "--csv"], ["front", "--json"], ["front", "--table"], ["tour"]],
    "fleet": [["fleet"], ["fleet", "--csv"], ["fleet", "--json"]],
    "robots": [["coverage"], ["coverage", "--csv"], ["coverage", "--table"]],
    "actors": [["actors"], ["actors", "--json"]],
}
PROBLEM = {
    "status": 422,
    "code": "invalid-request",
    "detail": "no",
    "request_id": "r",
    "title": "t",
}
JOB, STREAM = {"id": "f", "status": "queued"}, [progress(0.5), status("done")]


def hostile_services(answers: dict[str, Any]) -> Iterator[tuple[str, Service]]:
    """Services, each with one hostile text, and the commands that ask them."""
    # By day those that have most texts.
    for kind in few(4, ("named", "fleet", "robots", "actors", "front", "coverage")):
        commands = kind if kind in COMMANDS else "front"
        document = {**answers[kind], "status": "done"} if kind != "actors" else answers[kind]
        for path in places_of_texts(document):
            yield commands, Service(with_hostile(document, path), JOB, STREAM)
    for path in places_of_texts(PROBLEM):
        for commands in COMMANDS:
            yield commands, Service(with_hostile(PROBLEM, path), JOB, STREAM, code=422)
    failed = answers["failed"]
    for path in places_of_texts(failed):
        yield "front", Service(with_hostile(failed, path), JOB, [status("failed")])
    for path in places_of_texts(JOB):
        yield "front", Service(answers["front"], with_hostile(JOB, path), STREAM)
    stream = [list(event) for event in STREAM]
    for path in places_of_texts(stream):
        yield "front", Service(answers["front"], JOB, with_hostile(stream, path))


def test_no_text_of_an_answer_is_obeyed_by_a_terminal(
    url: str, tmp_path: Path, screen: Screen, monkeypatch: pytest.MonkeyPatch
) -> None:
    cities: Any = {"coordinates": [[0, 0, 1, 1]] * 3}
    for name, request in (("front", cities), ("fleet", fleet_request()), ("robots", ROBOTS)):
        (tmp_path / f"{name}.json").write_bytes(Plan("/", request).json)
    real = backends.Client
    services: list[Service] = []
    monkeypatch.setattr(
        backends,
        "Client",
        lambda url, **more: real(url, transport=httpx.MockTransport(services[-1]), **more),
    )
    shown = 0
    for commands, service in hostile_services(answers_of(url)):
        services.append(service)
        for name, *options in COMMANDS[commands]:
            file = [] if name == "actors" else [tmp_path / f"{commands}.json"]
            knee = ["--knee"] if name == "tour" else []
            arguments = [name, *file, *options, *knee, "--url", "http://service"]
            code, stdout, stderr = screen.run(*arguments)
            assert code in (0, 2, 3), (arguments, stderr)
            assert harmless(stdout + stderr), (arguments, stdout, stderr)
            assert "Traceback" not in stderr
            shown += "owned" in stdout + stderr
    assert len(services) > 50
    assert shown > 50
