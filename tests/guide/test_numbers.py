"""Numbers, defaults and commands in the README and the guide are those of the code."""

import json
import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from paretour import bodies
from pydantic import BaseModel
from typer.main import get_command

from service import front
from service.actor_info import RELEASED, read_actor_infos
from service.api import mcp, request_headers, stored_fronts
from service.cli.commands import app
from service.coverage import grid
from service.errors import Refusal
from service.files import fleets
from service.fleet import conflicts
from service.fleet import enumeration as all_plans
from service.jobs import outbox
from service.jobs.workers import worker_pool
from service.kinds.parsing import parse_task
from service.mcp import arguments, summaries, tools
from service.requests import breakpoint_fields, coverage, day_fields, fields, fleet_fields
from service.requests.coverage import CoverageRequest
from service.requests.front import FrontRequest
from service.requests.maps import day
from service.requests.notes import costs, places
from service.requests.task import TaskSource
from service.search import schedule, sizes
from service.settings import Settings, variable_of
from service.webhooks import sender
from tests.guide.pages import GUIDE, PAGES, README

WORDS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
NUMBERS = {word: number for number, word in enumerate((*WORDS, "eleven", "twelve"))}
SHARES = {0.25: "a quarter", 0.5: "half"}
SETTINGS = Settings.model_fields
LIMITS = Settings().limits


def prose(page: Path) -> str:
    """The text of a page in one line, so that a sentence is found wherever its lines break."""
    return " ".join(page.read_text(encoding="utf-8").split())


def cells(page: Path, heading: str) -> list[list[str]]:
    """The rows of the table with this heading, as cells."""
    table = page.read_text(encoding="utf-8").partition(heading)[2].partition("\n\n")[0]
    return [line.strip("| ").split(" | ") for line in table.splitlines() if line.startswith("| ")]


@pytest.mark.parametrize(
    ("sentence", "numbers"),
    [
        (r"up to (\w+) cities \((\w+) for an open route\)", [schedule.MAX_PROVED, 10]),
        (r"exact for up to (\w+) cities \(of closed tours, for up to (\w+)\)", [10, 11]),
        (r"nothing better for ([\d,]+) iterations per city", [schedule.PATIENCE]),
        (r"[Uu]p to (\w+) cities it tries all", [sizes.MAX_ENUMERATED]),
        (r"up to (\w+) stops to visit and (\w+) vehicles", [all_plans.MOST_STOPS, 6]),
        (r"it takes up to (\d+) s more", [front.BOUND_SECONDS]),
        (r"For up to (\d+) stops it also names stops", [conflicts.FEW_STOPS]),
        (r"a text of up to (\d+) characters", [fields.LONGEST_TEXT]),
        (r"the most load: whole numbers, up to (\d+)", [fleet_fields._MOST_DIMENSIONS]),
        (r"by default (\d+) and at most (\d+)", [20, stored_fronts._MOST_LISTED]),
        (r"The key has at most (\d+) characters", [request_headers._LONGEST_KEY]),
        (r"does not notice within (\d+) seconds", [worker_pool.STOP_SECONDS]),
        (r"200 to 299 within (\d+) seconds", [sender._SECONDS]),
        (r"after (\d+) seconds, 1 minute, 5 minutes, 30 minutes and 2 hours", [sender.PAUSES[0]]),
        (r"At most ([\d,]+) wait", [outbox.MOST_DELIVERIES]),
        (r"at most (\d+) bytes after decompression", [bodies.MOST_BYTES]),
        (r"A message may have up to (\d+) MiB", [mcp._MOST_BYTES / 2**20]),
        (r"describes; up to (\d+) MiB", [arguments._MOST_TEXT / 2**20]),
        (r"An answer has at most ([\d,]+) bytes", [summaries.MOST_BYTES]),
        (r"a smaller front: ([\d,]+) stops in all its tours", [tools._MOST_STOPS]),
        (r"what (\d+), (\d+) and (\d+) % more", [100 * slack for slack in summaries._SLACKS]),
        (r"their (\d+) largest `regions`", [grid._MOST_REGIONS]),
        (r"`robots` \| up to (\d+)", [coverage.MOST_ROBOTS]),
        (r"up to (\d+) pairs of a second and a factor", [day_fields._MOST_SLICES]),
        (
            r"Factors are from ([\d.]+) to (\d+), speeds from ([\d.]+) to (\d+)",
            [day_fields._LEAST_FACTOR, 100, day._LEAST_SPEED, day._MOST_SPEED],
        ),
        (
            r"There may be ([\d,]+) breakpoints of a pair, and ([\d,]+) in all objectives",
            [breakpoint_fields._MOST_OF_PAIR, LIMITS.breakpoints],
        ),
        (r"80 stops may have (\d+) for each pair", [LIMITS.breakpoints // (80 * 79)]),
        (r"At (\d+) bytes each", [LIMITS.body_bytes / LIMITS.breakpoints]),
        (r"lie more than ([\d,]+) km from the middle", [places._FAR / 1000]),
        (r"a stop more than (\d+) km from any other one", [places._APART / 1000]),
        (r"at least ([\d,]+) times the median", [costs._TIMES]),
        (
            r"(\d+) km/h, or (\d+) km/h if half of the stops are more than (\d+) km",
            [fleets._SPEED, fleets._SPEED_BETWEEN_TOWNS, fleets._CITY / 1000],
        ),
    ],
)
def test_a_number_in_a_sentence_is_that_of_the_code(sentence: str, numbers: list[float]) -> None:
    found = [each for page in PAGES for each in re.finditer(sentence, prose(page))]
    assert found
    for each in found:
        said = [NUMBERS.get(text) or float(text.replace(",", "")) for text in each.groups()]
        assert said == pytest.approx(numbers), each[0]


def test_the_pauses_between_attempts_are_those_that_are_said() -> None:
    assert sender.PAUSES == (5, 60, 5 * 60, 30 * 60, 2 * 3600)


def test_a_setting_has_the_default_that_its_row_says() -> None:
    rows = cells(GUIDE / "run-it-in-production.md", "| variable | default | meaning |")
    said = {row[0].strip("`"): row[1] for row in rows}
    computed = {"PARETOUR_ACTORS", "PARETOUR_WORKERS", "PARETOUR_ROUTER_PROFILE"}
    for name, field in SETTINGS.items():
        variable = field.validation_alias or variable_of(name)
        default = field.default
        if variable in computed:
            continue
        shown = {None: ["none"], (): ["none"], False: ["0", "false"]}.get(default, [str(default)])
        assert said[variable].removesuffix(".0") in [each.removesuffix(".0") for each in shown]


def test_a_limit_has_the_default_that_its_row_says() -> None:
    for limit, default, settings, _ in cells(
        GUIDE / "limits.md", "| limit | default | setting | refusal |"
    )[1:]:
        for name in re.findall(r"`PARETOUR_(\w+)`", settings):
            value: Any = SETTINGS[name.lower()].default
            shown = {"RATE": "1000 a minute"}.get(name) or SHARES.get(value) or f"{value:.0f}"
            assert shown in default or default.startswith("the same") or "`PARETOUR_" in default, (
                limit
            )


@pytest.mark.parametrize(("objectives", "most"), [(2, 10_000), (3, 10_000), (4, 10_000)])
def test_as_many_cities_are_taken_as_the_limits_say(objectives: int, most: int) -> None:
    infos = {info.name: info for info in read_actor_infos(RELEASED).values()}
    cities = np.random.default_rng(1).integers(0, 99, (most + 1, 2 * objectives)).tolist()
    for count in (most, most + 1):
        source = TaskSource("front", json.dumps({"coordinates": cities[:count]}).encode())
        if count == most:
            assert parse_task(source, LIMITS, infos).subject.n == most  # type: ignore[union-attr]
        else:
            with pytest.raises(Refusal, match=f"{most}"):
                parse_task(source, LIMITS, infos)


def test_the_readme_says_the_limits_of_cities() -> None:
    said = re.search(
        r"Up to ([\d,]+) cities for each request, (\d+) if costs are matrices, (\d+) for a fleet in"
        " straight lines",
        prose(README),
    )
    assert said is not None
    assert [int(each.replace(",", "")) for each in said.groups()] == [
        LIMITS.cities,
        LIMITS.matrix_cities,
        LIMITS.fleet_stops,
    ]


@pytest.mark.parametrize(
    ("page", "model"), [("plan-a-front", FrontRequest), ("cover-a-map", CoverageRequest)]
)
def test_a_field_of_a_request_has_the_default_that_its_row_says(
    page: str, model: type[BaseModel]
) -> None:
    rows = cells(GUIDE / f"{page}.md", "| field | default | meaning |")
    checked = 0
    for name, default, *_ in rows:
        field = model.model_fields[name.strip("`")]
        if re.fullmatch(r"null|true|false|-?[\d.]+|[a-z]+", default) and default != "none":
            plain = {"null": None, "true": True, "false": False}
            value = plain.get(default, default)
            assert str(field.get_default(call_default_factory=True)) == str(value), name
            checked += 1
    assert checked >= 4


def options_of(command: str) -> set[str]:
    known = get_command(app).commands[command]  # type: ignore[attr-defined]
    return {name for each in known.params for name in each.opts} | {"--help"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_command_in_a_sentence_has_the_options_that_are_named(page: Path) -> None:
    for text in re.findall(r"`(paretour [a-z]+[^`]*)`", prose(page)):
        command, *words = shlex.split(text.partition("paretour ")[2])
        named = {word.partition("=")[0] for word in words if word.startswith("--")}
        assert named <= options_of(command), text


def test_the_first_start_takes_as_long_on_every_page() -> None:
    said = {
        seconds
        for page in (README, GUIDE / "let-an-agent-plan.md", GUIDE / "first-tour-in-ten-minutes.md")
        for seconds in re.findall(r"some (\d+) s\b", prose(page))
    }
    assert said == {"40"}
