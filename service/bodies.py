"""JSON into and out of requests, without a detour through the framework's own parsing."""

from typing import Any

from pydantic_core import to_json
from starlette.requests import Request
from starlette.responses import Response

from service.problems import Refusal


async def json_body(request: Request, most_bytes: int) -> bytes:
    """The request's body, no longer than allowed and said to be JSON.

    Raises:
        Refusal: it is too long, or of another type.
    """
    _check_json(request)
    declared = request.headers.get("content-length", "")
    if declared.isdecimal() and int(declared) > most_bytes:
        raise _too_long(most_bytes, int(declared))
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > most_bytes:
            raise _too_long(most_bytes)
    return bytes(body)


def json_response(answer: Any, status: int = 200) -> Response:
    """An answer that is known to be well-formed and is not checked again."""
    return json_bytes(to_json(answer), status)


def json_bytes(answer: bytes, status: int = 200) -> Response:
    """An answer that was written as JSON before."""
    return Response(answer, status, media_type="application/json")


def _check_json(request: Request) -> None:
    given = request.headers.get("content-type")
    if given is None or given.partition(";")[0].strip().lower() != "application/json":
        sentence = f"Content-Type must be application/json, got {given or 'none'}"
        raise Refusal(415, "not-json", sentence)
    if (coding := request.headers.get("content-encoding", "identity").lower()) != "identity":
        raise Refusal(415, "not-plain", f"Content-Encoding must be identity, got {coding}")


def _too_long(limit: int, actual: int | None = None) -> Refusal:
    came = "more" if actual is None else actual
    return Refusal(
        413,
        "body-too-long",
        f"the body must have at most {limit} bytes, got {came}",
        limit=limit,
        actual=actual,
    )
