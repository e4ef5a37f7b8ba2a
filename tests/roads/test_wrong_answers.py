"""Answers of Valhalla and OSRM with one thing wrong: the refusal says what, and quotes no text."""

import copy
import json
import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from service.roads.osrm import Osrm
from service.roads.router import Answer, Unintelligible
from service.roads.valhalla import Valhalla

Read = Callable[[Answer], object]

OSRM, VALHALLA = Osrm("driving"), Valhalla("auto", 100.0)
PLACES = [(24.9, 60.1), (24.8, 60.2)]
TABLES = {"durations": [[0, 7.5], [8, 0]], "distances": [[0, 70], [80.5, 0]]}
LINE = "_p~iF~ps|U_ulLnnqC"
ANSWERS: dict[str, tuple[Any, Read]] = {
    "osrm snapped": (
        {"code": "Ok", "sources": [{"location": [24.9, 60.1]}, {"location": [24.8, 60.2]}]},
        lambda answer: OSRM.read_snapped(answer, PLACES),
    ),
    "osrm table": ({"code": "Ok", **TABLES}, lambda answer: OSRM.read_table(answer, (2, 2))),
    "osrm route": (
        {"code": "Ok", "routes": [{"legs": [{"steps": [{"geometry": LINE}]}]}]},
        lambda answer: OSRM.read_route(answer, 1),
    ),
    "valhalla snapped": (
        2 * [{"edges": [{"correlated_lat": 60.1, "correlated_lon": 24.9}]}],
        lambda answer: VALHALLA.read_snapped(answer, PLACES),
    ),
    "valhalla table": (
        {"sources_to_targets": TABLES, "units": "kilometers"},
        lambda answer: VALHALLA.read_table(answer, (2, 2)),
    ),
    "valhalla route": (
        {"trip": {"legs": [{"shape": LINE}]}},
        lambda answer: VALHALLA.read_route(answer, 1),
    ),
}
SECRET = "Mannerheimintie \x1b[2J"
WRONG = [True, -1.5, 10**30, float("inf"), float("nan"), SECRET, [], [SECRET], {}, {SECRET: 1}]
SENTENCE = re.compile(r"\S+ (must|is missing|refuses|places must|sources must|\w+ must)")


def paths(document: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the place of each value in a document, from the whole to the least."""
    yield path
    if isinstance(document, dict | list):
        items = document.items() if isinstance(document, dict) else enumerate(document)
        for key, value in items:
            yield from paths(value, (*path, key))


def changed(document: Any, path: tuple[Any, ...], value: Any = ...) -> Any:
    """Return a copy with a value at a place, or without what is there."""
    if not path:
        return value
    whole = part = copy.deepcopy(document)
    for key in path[:-1]:
        part = part[key]
    if value is ...:
        del part[path[-1]]
    else:
        part[path[-1]] = value
    return whole


def refused(read: Read, content: bytes) -> None:
    """Check that, if an answer is refused, a sentence says why."""
    try:
        read(Answer(200, content))
    except Unintelligible as error:
        sentence = str(error)
        assert SENTENCE.match(sentence) or sentence.startswith("a "), sentence
        assert sentence.isprintable()
        assert "Manner" not in sentence
        assert not re.search(r"[a-z]_[a-z]+$", sentence), sentence
        assert len(sentence) < 250


@pytest.mark.parametrize("name", ANSWERS)
def test_whatever_is_wrong_in_an_answer_a_sentence_says_it(name: str) -> None:
    document, read = ANSWERS[name]
    read(Answer(200, json.dumps(document).encode()))
    for path in paths(document):
        for value in WRONG:
            refused(read, json.dumps(changed(document, path, value)).encode())
        if path:
            refused(read, json.dumps(changed(document, path)).encode())
    for content in (b"", b"<html>", b"\xff", b"[" * 10_000, b'{"a":' * 10_000):
        with pytest.raises(Unintelligible, match=r"^it must be JSON: "):
            read(Answer(200, content))


@pytest.mark.parametrize(
    ("name", "path", "value", "sentence"),
    [
        ("osrm table", ("durations",), ..., "durations is missing"),
        ("osrm table", ("durations",), SECRET, "durations must be a valid array, got a text of 20"),
        (
            "osrm table",
            ("durations", 1, 0),
            -1.5,
            "durations/1/0 must be greater than or equal to 0, got -1.5",
        ),
        ("osrm table", (), [], "it must be an object, got a list of 0"),
        ("osrm table", ("distances", 0), [1], "a table must have 2 rows of 2 numbers"),
        ("osrm table", ("code",), "NoTable", "code must be 'Ok', got a text of 7"),
        (
            "valhalla table",
            ("sources_to_targets", "distances", 0, 1),
            True,
            "sources_to_targets/distances/0/1 must be a valid number, got true",
        ),
        ("valhalla table", ("units",), "miles", "units must be 'kilometers', got a text of 5"),
        ("valhalla route", ("trip", "legs", 0), {}, "trip/legs/0/shape is missing"),
    ],
)
def test_the_sentence_names_the_demand_and_what_came(
    name: str, path: tuple[Any, ...], value: Any, sentence: str
) -> None:
    document, read = ANSWERS[name]
    content = json.dumps(changed(document, path, value)).encode()
    with pytest.raises(Unintelligible, match=f"^{re.escape(sentence)}$"):
        read(Answer(200, content))
