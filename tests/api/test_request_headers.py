"""`Prefer` and `Idempotency-Key`, as requests write them."""

import pytest
from starlette.requests import Request

from service.api.request_headers import idempotency_key, prefers_async
from service.errors import Refusal


def request(*headers: tuple[str, str]) -> Request:
    raw = [(name.lower().encode(), value.encode("latin-1")) for name, value in headers]
    return Request({"type": "http", "headers": raw})


@pytest.mark.parametrize(
    ("preferences", "later"),
    [
        ([], False),
        (["respond-async"], True),
        (["Respond-Async; wait=10"], True),
        (["return=minimal, respond-async"], True),
        (["return=minimal", "respond-async"], True),
        (["respond-asynchronously"], False),
    ],
)
def test_an_answer_later_is_preferred_as_the_standard_says(
    preferences: list[str], later: bool
) -> None:
    assert prefers_async(request(*(("Prefer", each) for each in preferences))) is later


@pytest.mark.parametrize("key", ["k", "k" * 255, "two words", "!~"])
def test_a_key_is_printable_ascii(key: str) -> None:
    assert idempotency_key(request(("Idempotency-Key", key))) == key


def test_a_request_may_have_no_key() -> None:
    assert idempotency_key(request()) is None


@pytest.mark.parametrize(
    ("key", "sentence"),
    [
        ("", "got 0"),
        ("k" * 256, "got 256"),
        ("k\tk", "got 3, including other characters"),
        ("clé", "got 3, including other characters"),
    ],
)
def test_a_key_of_another_form_is_refused(key: str, sentence: str) -> None:
    with pytest.raises(Refusal) as refused:
        idempotency_key(request(("Idempotency-Key", key)))
    assert refused.value.code == "invalid-request"
    assert refused.value.detail.endswith(sentence)
