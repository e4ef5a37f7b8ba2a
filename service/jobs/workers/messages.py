"""Messages between the service and its worker processes: pickled, over two sockets each."""

import pickle
import struct
from asyncio import StreamReader
from collections.abc import AsyncIterator, Collection, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any, BinaryIO

from service.kinds.front_document import FrontDocument
from service.kinds.parts import Part
from service.requests.task import Task
from service.watch import Progress

_LENGTH = struct.Struct("!Q")


@dataclass(frozen=True)
class Do:
    """To an idle worker: run these tasks by number, in this order, and send all results at once."""

    tasks: Mapping[int, Task]


@dataclass(frozen=True)
class StopTask:
    """To a worker: end the task of this number, if it is still running."""

    number: int


@dataclass(frozen=True)
class WarmUp:
    """To a worker: compile these parts of the code, or load them from the cache."""

    parts: Collection[Part]


@dataclass(frozen=True)
class Warm:
    """From a worker: it has this part of the compiled code."""

    part: Part


class Stage(Enum):
    """From a worker: what it has come to."""

    STARTED = "its networks are loaded"
    SPENT = "it has grown too large, and ends after the results that follow"


@dataclass(frozen=True)
class Unable:
    """From a worker: it cannot work and ends, for this reason."""

    reason: str


@dataclass(frozen=True, eq=False)
class Found:
    """From a worker: the progress of a task that goes on, and its best front so far."""

    number: int
    progress: Progress
    front: FrontDocument


@dataclass(frozen=True, eq=False)
class Done:
    """From a worker: the task is done."""

    number: int
    front: FrontDocument


@dataclass(frozen=True, eq=False)
class Failed:
    """From a worker: the task raised this error, which has its traceback as a note."""

    number: int
    error: Exception


def encode(*messages: object) -> bytes:
    """Return messages as bytes, the length of each before it."""
    contents = [pickle.dumps(message, pickle.HIGHEST_PROTOCOL) for message in messages]
    return b"".join(_LENGTH.pack(len(content)) + content for content in contents)


async def received(reader: StreamReader) -> AsyncIterator[Any]:
    """Yield each message that a process sends, until the process is gone."""
    while True:
        try:
            (length,) = _LENGTH.unpack(await reader.readexactly(_LENGTH.size))
            content = await reader.readexactly(length)
        except (EOFError, OSError):
            return
        yield pickle.loads(content)


def receive(file: BinaryIO) -> Any:
    """Wait for the next message and return it.

    Raises:
        EOFError: The sender is gone.
        OSError: Likewise.
    """
    (length,) = _LENGTH.unpack(_read(file, _LENGTH.size))
    return pickle.loads(_read(file, length))


def _read(file: BinaryIO, size: int) -> bytes:
    content = file.read(size)
    if len(content) < size:
        raise EOFError
    return content
