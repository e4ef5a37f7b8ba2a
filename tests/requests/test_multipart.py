"""Multipart bodies: what comes out of them, and how long the worst of them take."""

import time

import httpx
import pytest

from service.errors import Refusal
from service.requests.multipart import split_parts

TYPE = "multipart/form-data; boundary="
HEADERS = b'\r\nContent-Disposition: form-data; name="request"\r\n\r\n'
LONGEST = 2**24  # bytes


@pytest.mark.parametrize(
    "content", [b"", b"\r\n", b"--x", b"\r\n--", b"\r\r\n\n-" * 1000, bytes(2**21)]
)
def test_parts_come_out_as_they_went_in(content: bytes) -> None:
    files = {"request": (None, b"{}"), "map": ("a.png", content, "image/png")}
    request = httpx.Request("POST", "http://x", files=files)
    parts = split_parts(request.headers["content-type"], request.read(), ("request", "map"))
    assert parts == {"request": b"{}", "map": content}


@pytest.mark.parametrize(
    ("boundary", "padding"),
    [
        ("x", b" "),
        ("x", b"\r\n--"),
        (70 * "a", b"a"),
        (70 * "-", b"-"),
        (70 * "a", b"\r\n--" + 69 * b"a"),
        (35 * "a" + 35 * "b", b"\r\n--" + 35 * b"a" + 34 * b"b"),
    ],
)
@pytest.mark.parametrize("where", ["before", "headers", "content", "behind"])
def test_padding_does_not_hang_the_service(boundary: str, padding: bytes, where: str) -> None:
    padding = padding * (LONGEST // len(padding))
    first = b"--" + boundary.encode()
    body = {
        "before": padding + first + HEADERS,
        "headers": first + b"\r\n" + padding,
        "content": first + HEADERS + padding,
        "behind": first + HEADERS + b"\r\n" + first + b"--" + padding,
    }[where]
    began = time.process_time()
    with pytest.raises(Refusal):
        split_parts(TYPE + boundary, body, ("request", "map"))
    assert time.process_time() - began < 20
