"""What the service and its worker processes say to one another, over a socket each."""

import pickle
import struct
from asyncio import StreamReader
from dataclasses import dataclass
from socket import socket
from typing import Any

from service.jobs.front_document import FrontDocument
from service.requests.task import Task, Work

_LENGTH = struct.Struct("!Q")


@dataclass(frozen=True, eq=False)
class Snapshot:
    """How far work has come, and the best front so far."""

    seconds: float
    hypervolume: float
    points: int
    front: FrontDocument


@dataclass(frozen=True)
class WarmUp:
    """To a worker: compile the search, or load it."""


@dataclass(frozen=True)
class Do:
    """To a worker that is idle: do this."""

    number: int
    work: Work | Task


@dataclass(frozen=True)
class Stop:
    """To a worker: come to an end with this, if it is still at it."""

    number: int


@dataclass(frozen=True)
class Started:
    """From a worker: its networks are loaded."""


@dataclass(frozen=True)
class Warm:
    """From a worker: the search is there as well."""


@dataclass(frozen=True, eq=False)
class Found:
    """From a worker: the work goes on, and this was found so far."""

    number: int
    snapshot: Snapshot


@dataclass(frozen=True, eq=False)
class Done:
    """From a worker: the work is done."""

    number: int
    front: FrontDocument


@dataclass(frozen=True, eq=False)
class Failed:
    """From a worker: the work was not possible. The error's own traceback is a note to it."""

    number: int
    error: Exception


def packed(message: object) -> bytes:
    """A message as bytes, its length first."""
    content = pickle.dumps(message, pickle.HIGHEST_PROTOCOL)
    return _LENGTH.pack(len(content)) + content


async def received(stream: StreamReader) -> Any:
    """The next message.

    Raises:
        EOFError: whoever sent is gone.
        OSError: likewise.
    """
    (length,) = _LENGTH.unpack(await stream.readexactly(_LENGTH.size))
    return pickle.loads(await stream.readexactly(length))


def received_now(connection: socket) -> Any:
    """The next message, for which the caller waits. Nothing that comes after it is read.

    Raises:
        EOFError: whoever sent is gone.
        OSError: likewise.
    """
    (length,) = _LENGTH.unpack(_exactly(connection, _LENGTH.size))
    return pickle.loads(_exactly(connection, length))


def _exactly(connection: socket, size: int) -> bytearray:
    content = bytearray()
    while len(content) < size:
        more = connection.recv(size - len(content))
        if not more:
            raise EOFError
        content += more
    return content
