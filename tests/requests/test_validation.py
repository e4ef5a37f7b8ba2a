"""JSON that does not fit a model is refused, each fault with its pointer and its sentence."""

import sys
from types import FrameType

import numpy as np
import pytest

from service.errors import MOST_FAULTS, Refusal
from service.requests.fields import PlanRequest
from service.requests.front import FrontRequest
from service.requests.validation import check_depth, nearest, parse_json, shorten


def refusal(body: bytes) -> Refusal:
    with pytest.raises(Refusal) as refused:
        parse_json(PlanRequest, body)
    return refused.value


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        (b"", "EOF"),
        (b"{", "EOF"),
        (b'{"preferences": [1, 2]', "EOF"),
        (b'{"preferences": [01]}', "invalid number"),
        (b"{'size': 1}", "key must be a string"),
        (b'{"actor": "\xff"}', "invalid unicode"),
        (b'{"actor": "\\ud800"}', "hex escape"),
        (b"[" * 50_000, "recursion limit exceeded"),
        (b'{"size": 1' + b"0" * 5000 + b"}", "number out of range"),
    ],
)
def test_a_body_that_is_not_json_is_malformed(body: bytes, sentence: str) -> None:
    refused = refusal(body)
    assert (refused.status, refused.code) == (400, "malformed-json")
    assert sentence in refused.detail


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        (b"[]", "the body must be an object, got a list of 0"),
        (b"null", "the body must be an object, got null"),
        (b'{"actor": {}}', "actor must be a valid string, got an object"),
        (
            b'{"time_limit": -1' + b"0" * 50 + b"}",
            "time_limit must be at least 0, got an integer of more than 40 digits",
        ),
    ],
)
def test_what_came_is_shown(body: bytes, sentence: str) -> None:
    refused = refusal(body)
    assert (refused.status, refused.code, refused.detail) == (422, "invalid-request", sentence)


def test_every_fault_is_told_up_to_a_number() -> None:
    refused = refusal(b'{"size": 0, "starts": 1}')
    assert [fault.pointer for fault in refused.errors] == ["/size", "/starts"]
    assert refused.detail == "size must be at least 1, got 0 (and 1 more)"
    many = refusal(b"{" + b",".join(b'"%d": 1' % i for i in range(30)) + b"}")
    assert len(many.errors) == MOST_FAULTS
    assert many.detail.endswith("(and 29 more)")


def test_a_long_text_is_shown_shortened() -> None:
    assert shorten("x" * 80) == "x" * 80
    assert shorten("x" * 81) == "x" * 79 + "…"


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        (
            b'{"objectives":[{"name":"a","coordinates":[[0]]},{"name":"b"}]}',
            "objectives/0/coordinates/0 must have 2 items, got 1",
        ),
        (b'{"coordinates":[[0,1,2]]}', "coordinates/0 must have 4 items or more, got 3"),
        (b'{"matrices":[[[0]]]}', "matrices must have 2 items or more, got 1"),
        (b'{"reference_point":[1,1,1,1,1]}', "reference_point must have 4 items or fewer, got 5"),
        (b'{"coordinates":[]}', "coordinates must have 1 item or more, got 0"),
    ],
)
def test_where_one_length_is_right_it_is_named(body: bytes, sentence: str) -> None:
    with pytest.raises(Refusal) as refused:
        parse_json(FrontRequest, body)
    assert refused.value.detail == sentence


@pytest.mark.parametrize(
    ("word", "words", "near"),
    [
        ("order-17", ["order-1", "order-71", "order-7", "order-171"], "order-171"),
        ("oslo-hub", ["oslo-hut-2", "oslo-bus", "Oslo-Hub", "oslo-hubs"], "Oslo-Hub"),
        ("dopet", ["depot", "dopet-2", "carpet"], "dopet-2"),
        ("warehouse", ["wharehose", "ware", "house"], "wharehose"),
        ("x", ["depot", "order-17"], None),
        ("", ["a"], None),
        ("depot", [], None),
    ],
)
def test_the_nearest_word_is_meant_not_the_first_near_one(
    word: str, words: list[str], near: str | None
) -> None:
    for _ in words or [""]:
        assert nearest(word, words) == near
        words = [*words[1:], *words[:1]]


def test_the_nearest_of_many_alike_words_is_found_in_a_bounded_number_of_comparisons() -> None:
    letters = np.array(list("ab" * 50))
    words = ["".join(np.random.default_rng(i).permutation(letters)) for i in range(10_000)]
    word = words[1234][:40] + "x" + words[1234][40:99]
    calls = []

    def profile(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and frame.f_code.co_name == "find_longest_match":
            calls.append(frame)

    sys.setprofile(profile)
    try:
        assert nearest(word, [*words, word + "y"]) == word + "y"
    finally:
        sys.setprofile(None)
    assert len(calls) < 10_000


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"[1, 2]",
        b'{"size": 1]]',
        99 * b"[" + 99 * b"]",
        1000 * b"[],",
        b'{"actor":"' + 1000 * b"[" + b'"}',
    ],
    ids=["empty", "flat", "malformed", "deep enough", "side by side", "in a string"],
)
def test_a_body_that_is_not_too_deep_passes_the_check_of_depth(body: bytes) -> None:
    check_depth(body)


@pytest.mark.parametrize(
    "body",
    [
        1000 * b"[" + 1000 * b"]",
        1000 * b'{"a":[',
        b'{"actor":"' + 1000 * b"]" + b'","x":' + 2000 * b"[",
    ],
    ids=["arrays", "objects", "behind a string of brackets"],
)
def test_a_body_that_is_too_deep_is_refused_by_the_check_of_depth(body: bytes) -> None:
    with pytest.raises(Refusal, match="recursion limit"):
        check_depth(body)


def test_the_check_of_depth_leaves_a_flat_body_unparsed(monkeypatch: pytest.MonkeyPatch) -> None:
    def parse(_: bytes) -> None:
        raise AssertionError("the body was parsed")

    monkeypatch.setattr("service.requests.validation.from_json", parse)
    check_depth(b'{"coordinates":[' + 20_000 * b"[0.25,0.5,0.75,1]," + b"[0,0,0,0]]}")
