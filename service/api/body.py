"""Request bodies: receive one within its limits, and split it into parts."""

import asyncio
from collections.abc import Mapping

from starlette.requests import Request

from service.api.body_budget import BodyAllowance
from service.errors import Refusal
from service.requests.byte_order_marks import without_mark
from service.requests.multipart import Files, split_files, split_parts
from service.requests.task import TaskKind, TaskSource

_MULTIPART = "multipart/form-data"
_UPLOADS: Mapping[TaskKind, str] = {"front": "matrices", "coverage": "map"}
_LONG_TO_JOIN = 2**20  # bytes


async def receive_source(
    request: Request, kind: TaskKind, most_bytes: int, allowance: BodyAllowance
) -> TaskSource:
    """Receive the body of a request for a front.

    The body is JSON, or multipart/form-data with the part `request`, which is JSON, and the file
    `matrices` or `map`. The body of a request to replan is always JSON.

    Raises:
        Refusal: The body is too long, of another type, or has other parts; or the budget of all
            bodies has no room for it.
    """
    content_type = _checked_content_type(request)
    body = await _receive(request, most_bytes, allowance)
    if not content_type.lower().startswith(_MULTIPART):
        return TaskSource(kind, await _unmarked(body))
    if kind not in _UPLOADS:
        raise Refusal("not-json", came=content_type)
    upload = _UPLOADS[kind]
    # In a thread, beside the event loop: many megabytes take a tenth of a second.
    parts = await asyncio.to_thread(split_parts, content_type, body, ("request", upload))
    return TaskSource(kind, await _unmarked(parts["request"]), parts[upload])


async def receive_files(request: Request, most_bytes: int, allowance: BodyAllowance) -> Files:
    """Receive the files of a request: the parts of a form.

    Raises:
        Refusal: As in receive_source.
    """
    content_type = _checked_content_type(request)
    if not content_type.lower().startswith(_MULTIPART):
        raise Refusal("not-files", came=content_type)
    body = await _receive(request, most_bytes, allowance)
    return await asyncio.to_thread(split_files, content_type, body)


async def receive_message(request: Request, most_bytes: int, allowance: BodyAllowance) -> bytes:
    """Receive the body of a message of an agent, which is JSON.

    Raises:
        Refusal: As in receive_source.
    """
    content_type = _checked_content_type(request)
    if content_type.lower().startswith(_MULTIPART):
        raise Refusal("not-json", came=content_type)
    return await _unmarked(await _receive(request, most_bytes, allowance))


async def _unmarked(body: bytes) -> bytes:
    """Return JSON without a byte order mark; a long one is decoded in a thread."""
    if len(body) < _LONG_TO_JOIN:
        return without_mark(body)
    return await asyncio.to_thread(without_mark, body)


def _checked_content_type(request: Request) -> str:
    content_type = request.headers.get("content-type", "")
    if content_type.partition(";")[0].strip().lower() not in ("application/json", _MULTIPART):
        raise Refusal("not-json", came=content_type or "none")
    if (coding := request.headers.get("content-encoding", "identity").lower()) != "identity":
        raise Refusal("not-plain", came=coding)
    return content_type


async def _receive(request: Request, most_bytes: int, allowance: BodyAllowance) -> bytes:
    declared = request.headers.get("content-length", "")
    if declared.isdecimal():
        if int(declared) > most_bytes:
            raise _too_long(most_bytes, int(declared))
        allowance.reserve(int(declared))
    # Joined at the end: appending would copy many megabytes again and again.
    chunks, length = [], 0
    async for chunk in request.stream():
        chunks.append(chunk)
        length += len(chunk)
        if length > most_bytes:
            raise _too_long(most_bytes)
        allowance.add(chunk)
    # A long body is joined in a thread: join releases the interpreter's lock.
    if length < _LONG_TO_JOIN:
        return b"".join(chunks)
    return await asyncio.to_thread(b"".join, chunks)


def _too_long(limit: int, actual: int | None = None) -> Refusal:
    came = "more" if actual is None else actual
    return Refusal("body-too-long", came=came, limit=limit, actual=actual)
