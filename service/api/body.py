"""JSON into and out of requests, without a detour through the framework's own parsing."""

import asyncio
from dataclasses import dataclass
from typing import Any

from pydantic_core import to_json
from starlette.requests import Request
from starlette.responses import Response

from service.api.multipart import parts
from service.errors import Refusal

_PARTED = "multipart/form-data"
_LONG = 2**20  # bytes


@dataclass(frozen=True)
class Body:
    """JSON, and the file that came beside it, if one did."""

    json: bytes
    upload: bytes | None = None


async def read_body(request: Request, most_bytes: int, upload: str) -> Body:
    """The request's body: JSON; or the part `request`, which is JSON, and the part `upload`.

    Raises:
        Refusal: it is too long, or of another type.
    """
    kind = _checked_type(request)
    body = await _whole_body(request, most_bytes)
    if not kind.lower().startswith(_PARTED):
        return Body(body)
    # Beside the event loop, because of many megabytes this takes a while.
    found = await asyncio.to_thread(parts, kind, body, ("request", upload))
    return Body(found["request"], found[upload])


async def _whole_body(request: Request, most_bytes: int) -> bytes:
    declared = request.headers.get("content-length", "")
    if declared.isdecimal() and int(declared) > most_bytes:
        raise _too_long(most_bytes, int(declared))
    # Joined at the end: to let many megabytes grow copies them time and again.
    chunks, length = [], 0
    async for chunk in request.stream():
        chunks.append(chunk)
        length += len(chunk)
        if length > most_bytes:
            raise _too_long(most_bytes)
    # Of many megabytes it takes a while; then join lets go of the interpreter, and others go on.
    return b"".join(chunks) if length < _LONG else await asyncio.to_thread(b"".join, chunks)


def json_response(answer: Any, status: int = 200) -> Response:
    """An answer that is known to be well-formed and is not checked again."""
    return json_bytes(to_json(answer), status)


def json_bytes(answer: bytes, status: int = 200) -> Response:
    """An answer that was written as JSON before."""
    return Response(answer, status, media_type="application/json")


def _checked_type(request: Request) -> str:
    given = request.headers.get("content-type", "")
    if given.partition(";")[0].strip().lower() not in ("application/json", _PARTED):
        sentence = f"Content-Type must be application/json or {_PARTED}, got {given or 'none'}"
        raise Refusal(415, "not-json", sentence)
    if (coding := request.headers.get("content-encoding", "identity").lower()) != "identity":
        raise Refusal(415, "not-plain", f"Content-Encoding must be identity, got {coding}")
    return given


def _too_long(limit: int, actual: int | None = None) -> Refusal:
    came = "more" if actual is None else actual
    return Refusal(
        413,
        "body-too-long",
        f"the body must have at most {limit} bytes, got {came}",
        limit=limit,
        actual=actual,
    )
