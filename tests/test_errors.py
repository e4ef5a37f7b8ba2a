"""The table of refusals holds every code that the service raises, and no other."""

import ast
import pickle
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from string import Formatter
from typing import Any

import pytest

from service.errors import (
    PROBLEMS,
    CityNames,
    Fault,
    InvalidCoverage,
    Refusal,
    TooManyPlaces,
    WorkerLost,
)
from service.errors.faults import SENTENCES
from service.errors.printable import printable, printable_lines
from service.errors.tours import OBSTACLES

SERVICE = Path(__file__).parents[1] / "service"
MAKERS = {
    *("invalid", "invalid_header", "uncoverable", "_refused", "_of_plan", "_fault", "Fault", "of"),
    *("fault", "refusal", "refuse", "_of_files", "_invalid"),
}
OF_PYDANTIC = {
    *("extra-forbidden", "greater-than-equal", "less-than-equal", "string-pattern-mismatch"),
    *("too-short", "too-long", "string-too-short", "string-too-long"),
}


@cache
def nodes() -> dict[Path, list[ast.AST]]:
    """The syntax of each module of the service: to read all takes a second and more."""
    paths = (path for path in SERVICE.rglob("*.py") if "client" not in path.parts)
    return {path: list(ast.walk(ast.parse(path.read_text()))) for path in paths}


def all_nodes() -> Iterator[ast.AST]:
    for each in nodes().values():
        yield from each


def codes_in(syntax: Iterable[ast.AST]) -> Iterator[str]:
    """The literal codes in calls of Refusal and in the attribute `code` of its classes."""
    for node in syntax:
        match node:
            case (
                ast.Call(func=ast.Name("Refusal"), args=[ast.Constant(str(code)), *_])
                | ast.Call(func=ast.Attribute(attr="__init__"), args=[ast.Constant(str(code)), *_])
            ):
                yield code
            case ast.ClassDef(body=body):
                for member in body:
                    match member:
                        case ast.Assign(targets=[ast.Name("code")], value=ast.Constant(str(code))):
                            yield code


def test_every_code_of_the_table_is_raised_and_every_code_raised_is_in_it() -> None:
    assert set(codes_in(all_nodes())) == set(PROBLEMS)


def test_no_code_is_raised_that_is_not_written_out() -> None:
    """The test above sees literal codes alone."""
    for path, syntax in nodes().items():
        if path.parent.name == "errors" or path.name == "openapi.py":
            continue
        for node in syntax:
            match node:
                case ast.Call(func=ast.Name("Refusal"), args=arguments):
                    assert isinstance(arguments[0], ast.Constant), (path, node.lineno)


@pytest.mark.parametrize(
    "refusal",
    [
        Refusal("over-limit", name="size", pointer="/size", limit=9, actual=10),
        WorkerLost(),
        TooManyPlaces(limit=50, actual=60),
        InvalidCoverage(
            Fault.of("places/0", "obstacle", given="[0, 1]"),
            Fault.of("places/1", "unreachable", other="/places/0"),
        ),
    ],
)
def test_a_refusal_travels_between_processes(refusal: Refusal) -> None:
    copy = pickle.loads(pickle.dumps(refusal))
    assert type(copy) is type(refusal)
    assert str(copy) == str(refusal)
    assert copy.document("id") == refusal.document("id")


def faults_in(syntax: Iterable[ast.AST]) -> Iterator[tuple[str, set[str] | None]]:
    """The literal codes of faults, with the names of their values; None where these come by **."""
    for node in syntax:
        if not isinstance(node, ast.Call):
            continue
        name = getattr(node.func, "id", getattr(node.func, "attr", ""))
        if name not in MAKERS:
            continue
        for argument in node.args:
            for each in ast.walk(argument):
                if isinstance(each, ast.Constant) and each.value in SENTENCES:
                    named = {keyword.arg for keyword in node.keywords}
                    yield each.value, None if None in named else {str(each) for each in named}


def unknown_in(syntax: Iterable[ast.AST]) -> Iterator[str]:
    """The texts that are given for the code of a fault or of an obstacle, and are none."""
    for node in syntax:
        match node:
            case ast.Call(
                func=ast.Name("invalid" | "uncoverable" | "invalid_header"), args=[_, code]
            ):
                known = SENTENCES
            case ast.Call(func=ast.Name("Obstacle"), args=[code, *_]):
                known = OBSTACLES
            case _:
                continue
        texts = [code.body, code.orelse] if isinstance(code, ast.IfExp) else [code]
        for text in texts:
            written = isinstance(text, ast.Constant) and text.value in known
            if not written and not isinstance(text, ast.Name):
                yield ast.unparse(text)


def test_every_sentence_of_a_fault_is_used_with_its_values() -> None:
    """Codes that are chosen before are looked for as texts; pydantic's are not in the code."""
    used = {str(node.value) for node in all_nodes() if isinstance(node, ast.Constant)}
    assert {code for code in SENTENCES if code not in used} == OF_PYDANTIC
    assert {code for code in OBSTACLES if code not in used} == set()
    assert list(unknown_in(all_nodes())) == []
    for code, given in faults_in(all_nodes()):
        fields = {name for _, name, _, _ in Formatter().parse(SENTENCES[code]) if name}
        optional = {"near", "values", "part", "pointer", "parameter", "row", "column"}
        assert given is None or "values" in given or fields <= given <= fields | optional, code


@pytest.mark.parametrize(
    ("fault", "document"),
    [
        (
            Fault.of("end", "not-an-index", noun="a city", last=4, came=9),
            {
                "detail": "end must be a city, 0 to 4, got 9",
                "pointer": "/end",
                "code": "not-an-index",
                "demand": "must be a city, 0 to 4, got 9",
                "values": {"noun": "a city", "last": 4, "came": 9},
            },
        ),
        (
            Fault.of("start", "not-an-id", came="depo", near="depot"),
            {
                "detail": 'start must be the id of a stop, got "depo"; did you mean "depot"?',
                "pointer": "/start",
                "code": "not-an-id",
                "demand": 'must be the id of a stop, got "depo"; did you mean "depot"?',
                "values": {"came": '"depo"', "near": "depot"},
            },
        ),
        (
            Fault.of("departure", "no-departure"),
            {
                "detail": "departure is required where costs change over the day,"
                " or stops have service",
                "pointer": "/departure",
                "code": "no-departure",
                "demand": "is required where costs change over the day, or stops have service",
            },
        ),
        (
            Fault("off-road", pointer="/stops/1/location", values={"stop": "'a'", "limit": 250}),
            {
                "detail": "stop 'a' must lie within 250 m of a road, and does not",
                "pointer": "/stops/1/location",
                "code": "off-road",
                "values": {"stop": "'a'", "limit": 250},
            },
        ),
        (
            Fault.of("speed", "not-positive", came=float("nan")),
            {
                "detail": "speed must be positive, got nan",
                "pointer": "/speed",
                "code": "not-positive",
                "demand": "must be positive, got nan",
                "values": {"came": "NaN"},
            },
        ),
    ],
    ids=lambda each: getattr(each, "code", ""),
)
def test_a_fault_says_its_code_and_its_values(fault: Fault, document: dict[str, Any]) -> None:
    assert fault.document == document


def test_the_fault_of_a_refusal_has_its_code_and_values() -> None:
    [fault] = Refusal("over-limit", name="size", pointer="/size", limit=9, actual=10).errors
    assert fault.document == {
        "detail": "size must be at most 9, got 10",
        "pointer": "/size",
        "code": "over-limit",
        "demand": "must be at most 9, got 10",
        "values": {"limit": 9, "actual": 10, "name": "size"},
    }


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Café 東京, 3 m²", "Café 東京, 3 m²"),
        ("a\x1b[2Jb\x07", "a?[2Jb?"),
        ("a\nb\tc\u00a0d\u2028e", "a b c d e"),
        ("\u202etxt.exe\u2066", "?txt.exe?"),
        ("a\x00b\x1cc\x9bd", "a?b?c?d"),
    ],
)
def test_what_would_move_a_cursor_or_turn_a_text_round_is_not_printed(
    text: str, shown: str
) -> None:
    assert printable(text) == shown


def test_a_text_of_several_lines_keeps_them() -> None:
    assert printable_lines("a\x1b[2J\r\nb") == "a?[2J \nb"


def test_of_many_cities_five_are_named() -> None:
    assert CityNames("stop").of(range(5)) == "stops 0, 1, 2, 3 and 4"
    assert CityNames("stop").of(range(7)) == "stops 0, 1, 2, 3, 4 and 2 more"
