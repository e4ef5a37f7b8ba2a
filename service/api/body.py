"""Request bodies: receive one within its limits, split it into parts, and parse it into a task."""

import asyncio
from collections.abc import Mapping

from anyio import BrokenWorkerProcess, CapacityLimiter, to_process
from starlette.requests import Request

from service.actor import ActorInfo
from service.errors import Refusal, WorkerLost
from service.requests.limits import Limits
from service.requests.multipart import split_parts
from service.requests.task import Task, TaskKind, TaskSource, parse_task

_MULTIPART = "multipart/form-data"
_UPLOADS: Mapping[TaskKind, str] = {"front": "matrices", "coverage": "map"}
_LONG_TO_JOIN = 2**20  # bytes
_SHORT_TO_PARSE = 2**17  # bytes: a few milliseconds, where many megabytes take seconds
_ATTEMPTS = 2


async def receive_source(request: Request, kind: TaskKind, most_bytes: int) -> TaskSource:
    """Receive the body of a request for a front.

    The body is JSON; or multipart/form-data with the part `request`, which is JSON, and the file
    `matrices` or `map`.

    Raises:
        Refusal: The body is too long, of another type, or of other parts.
    """
    content_type = _checked_content_type(request)
    body = await _receive(request, most_bytes)
    if not content_type.lower().startswith(_MULTIPART):
        return TaskSource(kind, body)
    upload = _UPLOADS[kind]
    # In a thread, beside the event loop: of many megabytes it takes a tenth of a second.
    parts = await asyncio.to_thread(split_parts, content_type, body, ("request", upload))
    return TaskSource(kind, parts["request"], parts[upload])


def _checked_content_type(request: Request) -> str:
    content_type = request.headers.get("content-type", "")
    if content_type.partition(";")[0].strip().lower() not in ("application/json", _MULTIPART):
        raise Refusal("not-json", came=content_type or "none")
    if (coding := request.headers.get("content-encoding", "identity").lower()) != "identity":
        raise Refusal("not-plain", came=coding)
    return content_type


async def _receive(request: Request, most_bytes: int) -> bytes:
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
    # In a thread where it takes a while: join lets go of the interpreter.
    if length < _LONG_TO_JOIN:
        return b"".join(chunks)
    return await asyncio.to_thread(b"".join, chunks)


def _too_long(limit: int, actual: int | None = None) -> Refusal:
    came = "more" if actual is None else actual
    return Refusal("body-too-long", came=came, limit=limit, actual=actual)


class TaskParser:
    """Parses bodies under these limits, for these actors: long ones in a process of their own.

    The process is started for the first long body, and again where it was lost. It parses one body
    at a time; others wait for it.
    """

    def __init__(self, limits: Limits, actors: Mapping[str, ActorInfo]) -> None:
        self._limits = limits
        self._actors = dict(actors)
        self._one_process = CapacityLimiter(1)

    async def parse(self, source: TaskSource) -> Task:
        """Return the task in a body.

        Raises:
            Refusal: The body is malformed or over a limit, or no actor serves it.
            InvalidInstance: The cities or the map cannot be planned.
            WorkerLost: The process died over the body, and so did the next.
        """
        if len(source.body) + len(source.upload or b"") <= _SHORT_TO_PARSE:
            return parse_task(source, self._limits, self._actors)
        for _ in range(_ATTEMPTS):
            # To join the body took a while, and to send it will: let other requests in between.
            await asyncio.sleep(0)
            try:
                return await to_process.run_sync(
                    parse_task,
                    source,
                    self._limits,
                    self._actors,
                    cancellable=True,
                    limiter=self._one_process,
                )
            except BrokenWorkerProcess:
                continue
        raise WorkerLost
