"""Request bodies: received within their limits, split into parts, and parsed into a task."""

import asyncio
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from math import inf

from anyio import BrokenWorkerProcess, CapacityLimiter, to_process
from python_multipart.exceptions import FormParserError
from python_multipart.multipart import Field, File, FormParser, parse_options_header
from starlette.requests import Request

from service.actor import ActorInfo
from service.errors import Refusal, WorkerLost
from service.requests.limits import Limits
from service.requests.task import Task, TaskSource, parse_task


def parts(content_type: str, body: bytes, expected: Collection[str]) -> dict[str, bytes]:
    """The content of each part by its name: all of those expected, once each, and no other.

    Raises:
        Refusal: it is not of parts, or of others.
    """
    reader = _Reader(expected)
    _, options = parse_options_header(content_type)
    try:
        parser = FormParser(
            "multipart/form-data",
            reader.take_field,
            reader.take_file,
            reader.end,
            options.get(b"boundary"),
            config={"MAX_MEMORY_FILE_SIZE": inf},
        )
        parser.write(body)
        parser.finalize()
    except FormParserError as error:
        raise _malformed(str(error)) from None
    if not reader.ended:
        raise _malformed("it ends before its last boundary")
    if missing := [name for name in expected if name not in reader.found]:
        raise _unexpected(f"the part {missing[0]} is required")
    return reader.found


class _Reader:
    """Takes the parts as they come."""

    def __init__(self, expected: Collection[str]) -> None:
        self.found: dict[str, bytes] = {}
        self.ended = False
        self._expected = expected

    def take_field(self, part: Field) -> None:
        self._take(part.field_name, part.value)

    def take_file(self, part: File) -> None:
        part.file_object.seek(0)
        self._take(part.field_name, part.file_object.read())

    def end(self) -> None:
        self.ended = True

    def _take(self, raw: bytes | None, content: bytes | None) -> None:
        name = (raw or b"").decode(errors="replace")
        if name not in self._expected or name in self.found:
            among = " and ".join(self._expected)
            raise _unexpected(f"the parts must be {among}, once each, got {name[:80]!r}")
        self.found[name] = content or b""


def _malformed(reason: str) -> Refusal:
    return Refusal("malformed-multipart", reason=reason)


def _unexpected(sentence: str) -> Refusal:
    return Refusal("invalid-parts", reason=sentence)


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


def _checked_type(request: Request) -> str:
    given = request.headers.get("content-type", "")
    if given.partition(";")[0].strip().lower() not in ("application/json", _PARTED):
        raise Refusal("not-json", came=given or "none")
    if (coding := request.headers.get("content-encoding", "identity").lower()) != "identity":
        raise Refusal("not-plain", came=coding)
    return given


def _too_long(limit: int, actual: int | None = None) -> Refusal:
    came = "more" if actual is None else actual
    return Refusal("body-too-long", came=came, limit=limit, actual=actual)


_SHORT = 2**17  # bytes that are read within a few milliseconds; many megabytes take seconds
_TRIES = 2


class Reader:
    """Reads within these limits, for these actors.

    The process is started for the first long body, and again where it was lost. It reads one body
    at a time; whoever sends another waits.
    """

    def __init__(self, limits: Limits, actors: Mapping[str, ActorInfo]) -> None:
        self._limits = limits
        self._actors = dict(actors)
        self._one = CapacityLimiter(1)

    async def read(self, source: TaskSource) -> Task:
        """Parse a request into its task.

        Raises:
            Refusal: there is none, it is over a limit, or no actor serves it.
            InvalidInstance: it cannot be planned.
            WorkerLost: the process did not survive it, nor did the next.
        """
        if len(source.body) + len(source.upload or b"") <= _SHORT:
            return parse_task(source, self._limits, self._actors)
        for _ in range(_TRIES):
            # To put it together took a while, and to hand it over will: others come in between.
            await asyncio.sleep(0)
            try:
                return await to_process.run_sync(
                    parse_task,
                    source,
                    self._limits,
                    self._actors,
                    cancellable=True,
                    limiter=self._one,
                )
            except BrokenWorkerProcess:
                continue
        raise WorkerLost
