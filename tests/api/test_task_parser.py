"""Bodies are parsed within bounds of time, memory, number and waiting."""

import asyncio
import json
import os
import tracemalloc
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
import psutil
import pytest
from anyio import BrokenWorkerProcess, to_process

from service.api.task_parser import ParserBounds, TaskParser
from service.errors import NoWorker, QueueFull, Refusal
from service.files.reading import NamedFile
from service.files.upload import Upload
from service.kinds.offers import parse_offers
from service.requests.replan.way import ReplanSource
from service.requests.task import Task, TaskSource
from tests.helpers.odd_actors import BusyActor, SleepyActor, WarningActor
from tests.helpers.offers import FIVE, HOUR, NEW_PLACE, NINE, as_stored, fleet_request, stored_fleet
from tests.helpers.serving import ACTORS, LIMITS

LARGE = replace(LIMITS, cities=1000, cells=2**20, size=1000, breakpoints=1000)
BOUNDS = ParserBounds(seconds=60, memory=2**30)
INFO = {actor.info.name: actor.info for actor in ACTORS}
NUMBERS = TaskSource("front", b'{"matrices":[[[' + 7_000_000 * b"0," + b"0]],[[0]]]}")
COSTS = np.random.default_rng(0).random((2, 100, 100)).tolist()
HONEST = TaskSource("front", json.dumps({"matrices": COSTS}).encode())


def parser(seconds: float = BOUNDS.seconds, memory: int = BOUNDS.memory) -> TaskParser:
    return TaskParser(LARGE, INFO, ParserBounds(seconds=seconds, memory=memory))


def parsing_processes(earlier: list[psutil.Process]) -> list[psutil.Process]:
    """The processes that parse, without those that there were earlier."""

    def parses(process: psutil.Process) -> bool:
        with suppress(psutil.Error):  # it has just ended
            return "anyio.to_process" in process.cmdline()
        return False

    children = [each for each in psutil.Process().children() if each not in earlier]
    return [each for each in children if parses(each)]


def refusal(source: TaskSource, parser: TaskParser) -> Refusal:
    with pytest.raises(Refusal) as refused:
        asyncio.run(parser.parse(source))
    return refused.value


@pytest.mark.parametrize(
    ("body", "sentence"),  # bodies are made by the tests, since every process collects them all
    [
        (
            lambda: json.dumps([f"{i:x}" for i in range(200_000)]).encode(),
            "the body must have at most 109000 strings, got 200000",
        ),
        (
            lambda: json.dumps({f"{i:x}": 0 for i in range(40_000)}).encode(),
            "the body must have at most 33000 members, got 40000",
        ),
        (
            lambda: b'{"grid":[' + 400_000 * b"[0]," + b"[0]]}",
            "the body must have at most 142072 arrays, got 400002",
        ),
        (lambda: b'{"coordinates":[' + 500_000 * b"[]," + b"[0]]}", "the body must have at most"),
    ],
)
def test_a_body_of_too_many_things_is_refused_before_it_is_parsed(
    body: Callable[[], bytes], sentence: str
) -> None:
    source = TaskSource("front", body())
    tracemalloc.start()
    try:
        # A process would be refused its time.
        refused = refusal(source, parser(seconds=0))
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 2**20
    assert (refused.code, refused.status) == ("body-too-complex", 413)
    assert refused.detail.startswith(sentence)


def test_a_body_that_takes_all_memory_ends_its_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RUST_BACKTRACE", "1")  # as developers may have it
    body = json.dumps({f"{i:x}": 0 for i in range(1_079_000)}).encode()
    limits, bounds = replace(LARGE, cities=100_000), ParserBounds(patience=60)
    with pytest.raises(Refusal) as refused:
        asyncio.run(TaskParser(limits, INFO, bounds).parse(TaskSource("front", body)))
    assert refused.value.code == "body-too-complex"


def test_a_body_that_takes_too_long_is_refused_and_its_process_goes_on() -> None:
    actors = {"pa-one-matrix": BusyActor(**vars(INFO["pa-one-matrix"]))}

    async def scenario() -> tuple[str, bool]:
        earlier = psutil.Process().children()  # of the tests before, which may not have ended yet
        with pytest.raises(Refusal) as refused:
            await TaskParser(LARGE, actors, ParserBounds(seconds=0.2)).parse(HONEST)
        left = parsing_processes(earlier)
        await parser().parse(HONEST)
        return refused.value.detail, parsing_processes(earlier) == left

    detail, same = asyncio.run(scenario())
    assert detail == "the body must be parsed within 0.2 s of a processor, and was not"
    assert same


def test_time_that_other_work_takes_does_not_count_until_it_is_far_too_long() -> None:
    actors = {"pa-one-matrix": SleepyActor(**vars(INFO["pa-one-matrix"]))}

    async def scenario(patience: float) -> Task | None:
        earlier = psutil.Process().children()
        parsing = TaskParser(LARGE, actors, ParserBounds(seconds=0.5, patience=patience))
        try:
            return await parsing.parse(HONEST)
        except NoWorker:
            async with asyncio.timeout(60):
                while parsing_processes(earlier):
                    await asyncio.sleep(0.01)
            return None

    assert asyncio.run(scenario(60)) is not None
    assert asyncio.run(scenario(0.1)) is None


def test_a_body_that_takes_too_much_memory_is_refused() -> None:
    refused = refusal(NUMBERS, parser(memory=2**26))
    assert refused.code == "body-too-complex"


@pytest.mark.parametrize("failures", [2, 3])
def test_a_body_is_not_to_blame_for_processes_that_start_too_slowly(
    failures: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    starts, started = [], to_process.run_sync

    async def start(*arguments: Any, **options: Any) -> Any:
        starts.append(arguments)
        if len(starts) <= failures:
            raise BrokenWorkerProcess  # as anyio does after 20 seconds
        return await started(*arguments, **options)

    monkeypatch.setattr("service.api.task_parser.to_process.run_sync", start)
    if failures == 2:
        assert asyncio.run(parser().parse(HONEST)).actor == "pa-one-matrix"
    else:
        assert (refusal(HONEST, parser()).code, len(starts)) == ("no-worker", 3)


def test_offers_may_take_their_time_limit_beside_the_seconds_of_parsing() -> None:
    asked = json.dumps(
        {
            "order": {"id": "new", "location": NEW_PLACE},
            "every": {"from": NINE, "to": FIVE, "length": HOUR},
            "time_limit": 30,
        }
    )
    front = as_stored(stored_fleet(fleet_request()))
    limits = replace(LARGE, seconds=60)
    task = parse_offers(ReplanSource(asked.encode(), front), limits, INFO)
    offers = asyncio.run(parser(seconds=0).find_offers(task))
    assert b'"possible":true' in offers


@pytest.mark.parametrize("refused", [False, True])
def test_warnings_of_the_process_are_logged(
    refused: bool, caplog: pytest.LogCaptureFixture
) -> None:
    actors = {"x": WarningActor(**vars(INFO["pa-one-matrix"]))}
    asked = {"matrices": COSTS, "actor": "y"} if refused else {"matrices": COSTS}
    source = TaskSource("front", json.dumps(asked).encode())
    with suppress(Refusal):
        asyncio.run(TaskParser(LARGE, actors, BOUNDS).parse(source))
        assert not refused
    lines = [record for record in caplog.records if record.name == "py.warnings"]
    assert len(lines) == 10
    assert lines[3].getMessage().startswith("choice.py:3: RuntimeWarning: over\nflowover")
    assert max(len(line.getMessage()) for line in lines) == 500


def test_an_honest_body_does_not_wait_for_longer_ones() -> None:
    async def scenario() -> tuple[bool, Task]:
        parsing = parser()
        # By now there are both processes.
        both = parsing.parse(HONEST), parsing.parse(NUMBERS)
        await asyncio.gather(*both, return_exceptions=True)
        crowd = [asyncio.create_task(parsing.parse(NUMBERS)) for _ in range(5)]
        await asyncio.sleep(0.1)
        task = await parsing.parse(HONEST)
        waited = all(each.done() for each in crowd)
        for each in crowd:
            each.cancel()
        await asyncio.gather(*crowd, return_exceptions=True)
        return waited, task

    waited, task = asyncio.run(scenario())
    assert task.actor == "pa-one-matrix"
    assert not waited


def test_a_client_of_a_short_file_is_served_before_the_next_file_of_another() -> None:
    rows = b"".join(b"s%d,60.%d,24.5\n" % (at, at) for at in range(1000))
    long = Upload([NamedFile("long.csv", b"id,lat,lon\n" + rows)], None)
    short = Upload([NamedFile("short.csv", b"id,lat,lon\na,60,24\nb,61,25\n")], None)

    async def scenario() -> int:
        parsing = parser()
        crowd = [asyncio.create_task(parsing.read_files(long, "a")) for _ in range(8)]
        await asyncio.sleep(0)
        await parsing.read_files(short, "b")
        done = sum(each.done() for each in crowd)
        await asyncio.gather(*crowd)
        return done

    assert asyncio.run(scenario()) <= 2


def test_a_process_that_parses_gives_way_to_the_event_loop() -> None:
    async def niceness() -> list[int]:
        earlier = psutil.Process().children()  # of the tests before, which may not have ended yet
        await parser().parse(HONEST)
        return [each.nice() for each in parsing_processes(earlier)]

    assert asyncio.run(niceness()) == [min(os.nice(0) + 5, 19)]


def test_a_line_that_is_too_long_is_refused() -> None:
    async def scenario() -> list[BaseException | Task]:
        parsing = parser(seconds=1)
        crowd = [parsing.parse(NUMBERS) for _ in range(30)]
        return await asyncio.gather(*crowd, return_exceptions=True)

    outcomes = asyncio.run(scenario())
    assert sum(isinstance(outcome, QueueFull) for outcome in outcomes) >= 13
    assert all(isinstance(outcome, Refusal) for outcome in outcomes)


def test_an_initial_tour_of_countless_faults_is_refused_at_the_first() -> None:
    tour = 50_000 * b"-1," + b"0"
    body = b'{"coordinates":[[0,0,0,0]],"initial_tours":[[' + tour + b"]]}"
    refused = refusal(TaskSource("front", body), parser())
    assert refused.detail == "initial_tours/0/0 must be at least 0, got -1"


@pytest.mark.parametrize(
    "body",
    [
        b'{"stops":' + 1000 * b'[{"a":' + b"1" + 1000 * b"}]" + b"}",
        b'{"coordinates":' + 300_000 * b"[",
        b'{"actor":"' + 200_000 * b'\\"' + b'","x":' + 1000 * b'{"x":',
    ],
    ids=["balanced", "arrays", "objects behind a text"],
)
@pytest.mark.parametrize("replanned", [False, True])
def test_json_that_is_too_deep_is_refused_before_a_process_is_started(
    body: bytes, replanned: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def start(*_: object, **__: object) -> None:
        raise AssertionError("a process was asked for")

    monkeypatch.setattr("service.api.task_parser.to_process.run_sync", start)
    task_parser = TaskParser(replace(LARGE, cities=200_000), INFO, BOUNDS)

    async def parse() -> None:
        if replanned:
            task_parser.check_replan(body)
        else:
            await task_parser.parse(TaskSource("front", body))

    with pytest.raises(Refusal, match="recursion limit") as refused:
        asyncio.run(parse())
    assert refused.value.code == "malformed-json"
