"""Clients that load a server: as fast as it answers, or at a rate whatever it answers."""

import http.client
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
_PATIENCE = 60  # seconds that a client waits for an answer


@dataclass(frozen=True)
class Asked:
    """An answer: its status, and the seconds from when it was due to be asked for."""

    status: int
    seconds: float


class Client:
    """One connection, kept alive, of the client that takes the least time from the server."""

    def __init__(self, address: tuple[str, int]) -> None:
        self._connection = http.client.HTTPConnection(*address, timeout=_PATIENCE)

    def ask(self, method: str, path: str, body: bytes | None = None) -> int:
        """The status of the answer, which has been read to its end."""
        headers = {} if body is None else {"Content-Type": "application/json"}
        self._connection.request(method, path, body, headers)
        answer = self._connection.getresponse()
        answer.read()
        return answer.status

    def close(self) -> None:
        """Hang up."""
        self._connection.close()


def as_fast_as_answered(
    address: tuple[str, int], bodies: Iterable[bytes], clients: int, seconds: float
) -> list[Asked]:
    """Fronts, each client asking again as soon as it has been answered."""
    asking = _Shared(cycle(bodies))
    until = time.perf_counter() + seconds

    def client(_: int) -> list[Asked]:
        answers = []
        with _client(address) as ask:
            while (began := time.perf_counter()) < until:
                status = ask("POST", "/front", next(asking))
                answers.append(Asked(status, time.perf_counter() - began))
        return answers

    return _together(client, clients)


def at_a_rate(
    address: tuple[str, int], bodies: Iterable[bytes], rate: float, seconds: float, seed: int = 0
) -> list[Asked]:
    """Fronts asked for at random times, so many a second on average, as independent people do.

    The seconds of each count from when it was due, so that no delay hides behind another.
    """
    gaps = np.random.default_rng(seed).exponential(1 / rate, int(rate * seconds))
    began = time.perf_counter() + 0.1
    asking = _Shared(zip(began + np.cumsum(gaps), cycle(bodies), strict=False))

    def client(_: int) -> list[Asked]:
        answers = []
        with _client(address) as ask:
            for due, body in asking:
                time.sleep(max(0, due - time.perf_counter()))
                status = ask("POST", "/front", body)
                answers.append(Asked(status, time.perf_counter() - due))
        return answers

    return _together(client, 64)


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
    milliseconds: NDArray[np.float64] = 1000 * np.array([each.seconds for each in answers])
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
