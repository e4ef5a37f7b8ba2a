"""Bodies of ten megabytes, of every kind, sent again and again beside what is measured.

And bodies with as many lists as any may have, of which none can be planned.
"""

import gzip
import json
import threading
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import cache
from typing import NamedTuple, Self

import numpy as np

from tests.benchmarks.traffic import Client

LONG = 10_000_000  # bytes
_BYTES, _LISTS = 2**24 - 200, 2_180_000  # nearly as many as a body may have
_BY_PAIR = (
    b'{"departure":0,"stops":[{"id":"a"},{"id":"b"}],"objectives":[{"name":"t","breakpoints":['
)
_SHAPES = (  # of lists: the head of a body, what it repeats, and its tail
    (b'{"coordinates":[', b"[0,0,0,0],", b"[]]}"),
    (b'{"matrices":[', b"[],", b"[]]}"),
    (b'{"matrices":[[', b"[0],", b"[]]]}"),
    (b'{"matrices":[[[', b"0," * 8, b"0]]]}"),
    (b'{"seed":null,"matrices":[[', b"[0],", b"[]]]}"),
    (b'{"unknown":[', b"[" * 90 + b"]" * 90 + b",", b"0]}"),
    (b'{"coordinates":[[0,0,0,0]],"initial_tours":[', b"[0],", b"[]]}"),
    (_BY_PAIR, b"[[[0,5]]],", b"[]]}]}"),
    (_BY_PAIR + b"[", b"[[0,5]],", b"[]]]}]}"),
)
_PAUSE = 0.2  # seconds of a sender between two bodies


class Long(NamedTuple):
    """A body, and its content coding."""

    body: bytes
    coding: str = "identity"


def kinds() -> Mapping[str, Long]:
    """Bodies that can be planned, that cannot, that are not JSON, and that are compressed."""
    n = 510
    rng = np.random.default_rng(0)
    costs = rng.random((2, n, n)).tolist()
    row = "[0.25, 0.5, 0.75, 0.125], "
    return {
        "matrices": Long(json.dumps({"matrices": costs, "time_limit": 0}).encode()),
        "too many cities": Long(
            f'{{"coordinates": [{(LONG // len(row)) * row}[0, 0, 0, 0]]}}'.encode()
        ),
        "brackets": Long(b"[" * LONG),
        "gzip": Long(gzip.compress(rng.bytes(LONG), 1), "gzip"),
    }


@cache
def lists() -> Sequence[bytes]:
    """Bodies of fronts with as many lists as one may have under the default settings, or bytes."""
    return [
        head + unit * min(_BYTES // len(unit), _LISTS // max(unit.count(b"["), 1)) + tail
        for head, unit, tail in _SHAPES
    ]


class Senders:
    """One for each kind, for as long as the block lasts. Counts what was answered."""

    def __init__(self, address: tuple[str, int]) -> None:
        self._address = address
        self._stop = threading.Event()
        self._statuses = {kind: Counter[str]() for kind in kinds()}
        self._threads = [
            threading.Thread(target=self._send, args=(kind, long)) for kind, long in kinds().items()
        ]

    @property
    def statuses(self) -> dict[str, dict[str, int]]:
        """How often each status came, by kind; where the service hung up, there is none."""
        return {kind: dict(counted) for kind, counted in self._statuses.items()}

    def __enter__(self) -> Self:
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        for thread in self._threads:
            thread.join()

    def _send(self, kind: str, long: Long) -> None:
        while not self._stop.wait(_PAUSE):
            status = "none"
            client = Client(self._address)
            # What is refused by its head alone may not be read to its end.
            with suppress(ConnectionError):
                status = str(client.ask("POST", "/front", long.body, long.coding))
            client.close()
            self._statuses[kind][status] += 1
