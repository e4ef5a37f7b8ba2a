"""Long answers are compressed where a request accepts gzip, and are the same answers."""

import asyncio
import gzip

import pytest
from starlette.requests import Request
from starlette.responses import Response

from service.api.request_headers import accepts_gzip
from service.api.responses import LEAST_COMPRESSED as LEAST
from service.api.responses import compressed

LONG = b"[" + b"17," * LEAST + b"17]"


def asking(*accepted: str) -> Request:
    headers = [(b"accept-encoding", each.encode()) for each in accepted]
    return Request({"type": "http", "headers": headers})


@pytest.mark.parametrize(
    ("accepted", "takes"),
    [
        ((), False),
        (("gzip",), True),
        (("br, GZIP;q=0.5",), True),
        (("br", "gzip"), True),
        (("gzip;q=0",), False),
        (("*, gzip; q=0.000",), False),
        (("*",), True),
        (("identity, gzipped",), False),
    ],
)
def test_gzip_is_for_requests_that_accept_it(accepted: tuple[str, ...], takes: bool) -> None:
    request = asking(*accepted)
    assert accepts_gzip(request) is takes
    answer = asyncio.run(compressed(request, Response(LONG, headers={"Vary": "Accept"})))
    assert answer.headers["vary"] == "Accept, Accept-Encoding"
    assert answer.headers["content-length"] == str(len(answer.body))
    assert (answer.headers.get("content-encoding") == "gzip") is takes
    assert (gzip.decompress(answer.body) if takes else answer.body) == LONG


def test_short_answers_are_sent_as_they_are() -> None:
    answer = asyncio.run(compressed(asking("gzip"), Response(b"[" + b" " * (LEAST - 2))))
    assert (len(answer.body), "content-encoding" in answer.headers) == (LEAST - 1, False)
