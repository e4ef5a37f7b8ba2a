"""Clients that load a server: as fast as it answers, or at a rate whatever it answers."""

import re
import socket
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import cycle
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T")
Array = NDArray[np.float64]
MOST_AT_ONCE = 64  # connections of requests that come when they are due
_PATIENCE = 60  # seconds that a client waits for an answer
_LENGTH = re.compile(rb"(?i)\r\ncontent-length: *(\d+)")


@dataclass(frozen=True)
class Asked:
    """An answer: its status, and the seconds from when it was due to be asked for."""

    status: int
    seconds: float


class Client:
    """One connection, kept alive. A request goes out in one piece, and of the answer only what
    says where it ends is looked at: a client takes its time from the same cores as the server.
    """

    def __init__(self, address: tuple[str, int], source: str = "127.0.0.1") -> None:
        self._socket = socket.create_connection(address, _PATIENCE, (source, 0))

    def ask(self, method: str, path: str, body: bytes = b"", coding: str = "identity") -> int:
        """The status of the answer, which has been received to its end."""
        head = (
            f"{method} {path} HTTP/1.1\r\nHost: paretour\r\nContent-Type: application/json\r\n"
            f"Content-Encoding: {coding}\r\nContent-Length: {len(body)}\r\n\r\n"
        )
        self._socket.sendall(head.encode() + body)
        return self._status()

    def close(self) -> None:
        """Hang up."""
        self._socket.close()

    def _status(self) -> int:
        received = self._received()
        while b"\r\n\r\n" not in received:
            received += self._received()
        head, _, body = received.partition(b"\r\n\r\n")
        length = _LENGTH.search(head)
        if length is None:
            raise ValueError(f"an answer must say its length, got {head!r}")
        missing = int(length[1]) - len(body)
        while missing > 0:
            missing -= len(self._received())
        return int(head.split(b" ", 2)[1])

    def _received(self) -> bytes:
        received = self._socket.recv(2**16)
        if not received:
            raise ConnectionError("the server must answer, and hung up")
        return received


def as_fast_as_answered(
    address: tuple[str, int], bodies: Iterable[bytes], clients: int, seconds: float
) -> list[Asked]:
    """Fronts that came in that time, each client asking again as soon as it has been answered."""
    asking = _Shared(cycle(bodies))
    until = time.perf_counter() + seconds

    def client(_: int) -> list[Asked]:
        answers = []
        with _client(address) as ask:
            while (began := time.perf_counter()) < until:
                status = ask("POST", "/front", next(asking))
                if (ended := time.perf_counter()) < until:
                    answers.append(Asked(status, ended - began))
        return answers

    return _together(client, clients)


def evenly(rate: float, seconds: float) -> Array:
    """The times of a number of requests a second, evenly spaced."""
    return np.arange(int(rate * seconds)) / rate


def at_random(rate: float, seconds: float, seed: int = 0) -> Array:
    """The times of a number of requests a second, from independent people.

    For two servers that take always the same time and are busy for 80 % of it, the 99th percentile
    is then 3.9 times the median (simulated).
    """
    gaps = np.random.default_rng(seed).exponential(1 / rate, int(rate * seconds))
    return np.cumsum(gaps)


def when_due(address: tuple[str, int], bodies: Iterable[bytes], dues: Array) -> list[Asked]:
    """Fronts asked for at these seconds from now, whatever has been answered by then.

    The seconds of each count from when it was due, so that no delay hides behind another.
    """
    began = time.perf_counter() + 0.1
    asking = _Shared(zip(began + dues, cycle(bodies), strict=False))

    def client(_: int) -> list[Asked]:
        answers = []
        with _client(address) as ask:
            for due, body in asking:
                time.sleep(max(0, due - time.perf_counter()))
                status = ask("POST", "/front", body)
                answers.append(Asked(status, time.perf_counter() - due))
        return answers

    return _together(client, MOST_AT_ONCE)


def now_and_then(
    address: tuple[str, int], path: str, every: float, stop: threading.Event
) -> list[Asked]:
    """A path asked for again and again, until told to stop."""
    answers = []
    with _client(address) as ask:
        while not stop.wait(every):
            began = time.perf_counter()
            status = ask("GET", path)
            answers.append(Asked(status, time.perf_counter() - began))
    return answers


def quantiles(answers: Iterable[Asked]) -> dict[str, float]:
    """Milliseconds of the answers."""
    milliseconds: Array = 1000 * np.array([each.seconds for each in answers])
    median, late = np.quantile(milliseconds, [0.5, 0.99])
    return {
        "median_ms": round(float(median), 2),
        "p99_ms": round(float(late), 2),
        "worst_ms": round(float(milliseconds.max()), 2),
    }


@contextmanager
def _client(address: tuple[str, int]) -> Iterator[Callable[..., int]]:
    client = Client(address)
    try:
        yield client.ask
    finally:
        client.close()


def _together(client: Callable[[int], list[Asked]], clients: int) -> list[Asked]:
    with ThreadPoolExecutor(clients) as pool:
        return [answer for answers in pool.map(client, range(clients)) for answer in answers]


class _Shared(Generic[T]):
    """An iterator that several threads take from."""

    def __init__(self, items: Iterator[T]) -> None:
        self._items = items
        self._lock = threading.Lock()

    def __iter__(self) -> Iterator[T]:
        return self

    def __next__(self) -> T:
        with self._lock:
            return next(self._items)
