"""Messages between the service and its worker processes: pickled, over two sockets each."""

import pickle
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from socket import socket
from typing import Any

from service.front import Progress
from service.kinds.front_document import FrontDocument
from service.requests.task import Task

_LENGTH = struct.Struct("!Q")


@dataclass(frozen=True)
class WarmUp:
    """To a worker: compile the search, or load it from the cache."""


@dataclass(frozen=True)
class Do:
    """To an idle worker: run these tasks by number, in this order, and send all results at once."""

    tasks: Mapping[int, Task]


@dataclass(frozen=True)
class Stop:
    """To a worker: end the task of this number, if it is still running."""

    number: int


@dataclass(frozen=True)
class Started:
    """From a worker: its networks are loaded."""


@dataclass(frozen=True)
class Unable:
    """From a worker: it cannot work and ends, for this reason."""

    reason: str


@dataclass(frozen=True)
class Warm:
    """From a worker: the search is compiled."""


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


def decode(received: bytearray) -> Iterator[Any]:
    """Yield the messages that have been received whole, and remove each from the bytes."""
    while len(received) >= _LENGTH.size:
        (length,) = _LENGTH.unpack_from(received)
        end = _LENGTH.size + length
        if len(received) < end:
            return
        message = pickle.loads(received[_LENGTH.size : end])
        del received[:end]
        yield message


def receive_blocking(connection: socket) -> Any:
    """Wait for the next message and return it. No byte beyond it is read.

    Raises:
        EOFError: The sender is gone.
        OSError: Likewise.
    """
    (length,) = _LENGTH.unpack(_receive_exactly(connection, _LENGTH.size))
    return pickle.loads(_receive_exactly(connection, length))


def _receive_exactly(connection: socket, size: int) -> bytearray:
    content = bytearray()
    while len(content) < size:
        chunk = connection.recv(size - len(content))
        if not chunk:
            raise EOFError
        content += chunk
    return content
