"""Crowds that attack a service, each from an address of its own, in a process beside the benchmark.

Stalled uploads, idle connections, clients that hang up, repeats of a key on a full queue, hostile
bodies, and long ones of two million lists. Each counts what it was answered.
"""

import asyncio
import json
import random
import time
from collections import Counter
from collections.abc import Awaitable, Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import httpx
import numpy as np

from service.requests.task import TaskSource
from tests.benchmarks.long_bodies import lists
from tests.fuzz.attack import message_of, strict_json
from tests.fuzz.bodies import GENERATORS, extreme

UPLOADS, UPLOAD_BYTES = 160, 2**24
UPLOAD_RATE = 10**8 // UPLOADS  # bytes a second of each: together about a gigabit
IDLE_ADDRESSES, IDLE_EACH = 5, 220  # 1,100 connections: more than there are descriptors
HANGING_UP = 2
REPEATS = 60
HOSTILE = 2
LISTS = 3
_CHUNK = bytes(2**16).replace(b"\0", b" ")
_PAUSE = 0.5  # seconds of a client that was refused, until it comes again
_REFUSED = (ConnectionError, OSError, asyncio.IncompleteReadError, TimeoutError)
_PLANNED = {"preferences": 5, "size": 20}

Server = tuple[str, int]


@dataclass
class Crowd:
    """What the members of a crowd share: the server, their address, the end, and what they saw.

    Attributes:
        answers: How often each status came, or that the server closed the connection.
        faults: Answers that must not be.
    """

    server: Server
    source: str
    until: float
    answers: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)

    @property
    def over(self) -> bool:
        """Whether the attack has ended."""
        return time.monotonic() >= self.until

    async def connect(self) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        """Return a new connection from the address of the crowd."""
        return await asyncio.open_connection(*self.server, local_addr=(self.source, 0))

    def client(self) -> httpx.AsyncClient:
        """Return a client that calls from the address of the crowd."""
        transport = httpx.AsyncHTTPTransport(
            local_address=self.source, limits=httpx.Limits(max_connections=None)
        )
        url = f"http://{self.server[0]}:{self.server[1]}"
        return httpx.AsyncClient(base_url=url, transport=transport, timeout=120)

    def answered(self, answer: httpx.Response) -> Any:
        """Count an answer, note whether it is a fault, and return its JSON."""
        self.answers[str(answer.status_code)] += 1
        if answer.status_code >= 500 and answer.status_code != 503:
            self.faults.append(f"{answer.status_code} {answer.text[:300]}")
        try:
            return strict_json(answer.content)
        except ValueError as error:
            self.faults.append(f"{error}: {answer.text[:300]}")


Deed = Callable[[Crowd, int], Awaitable[None]]


class Kind(NamedTuple):
    """A kind of crowd: its address, how many members it has, and what each does again and again."""

    source: str
    count: int
    deed: Deed


Crowds = Mapping[str, Kind]


async def _attack(server: Server, until: float, kinds: Crowds) -> dict[str, dict[str, Any]]:
    crowds = {name: Crowd(server, kind.source, until) for name, kind in kinds.items()}
    async with asyncio.TaskGroup() as members:
        for name, kind in kinds.items():
            for number in range(kind.count):
                members.create_task(_member(crowds[name], kind.deed, number))
    return {
        name: {"answers": dict(sorted(crowd.answers.items())), "faults": crowd.faults[:20]}
        for name, crowd in crowds.items()
    }


async def _member(crowd: Crowd, deed: Deed, number: int) -> None:
    """Do a deed again and again until the attack is over."""
    await asyncio.sleep(random.Random(number).random())
    while not crowd.over:
        try:
            async with asyncio.timeout(max(crowd.until - time.monotonic(), 0.01)):
                await deed(crowd, number)
        except (*_REFUSED, httpx.TransportError):
            if not crowd.over:
                crowd.answers["closed"] += 1
                await asyncio.sleep(_PAUSE)


async def _stall_an_upload(crowd: Crowd, _: int) -> None:
    """Send all but the last byte of a long body, and wait for what the server does."""
    reader, writer = await crowd.connect()
    with _closing(writer):
        writer.write(_head(UPLOAD_BYTES))
        sending = asyncio.create_task(_send(writer, UPLOAD_BYTES - 1))
        try:
            status = await _status(reader)
        finally:
            sending.cancel()
            with suppress(asyncio.CancelledError, *_REFUSED):
                await sending
        crowd.answers[status] += 1
    await asyncio.sleep(_PAUSE)


async def _be_idle(crowd: Crowd, number: int) -> None:
    """Say nothing, or drip a head, until the server closes the connection."""
    source = f"127.0.0.{101 + number // IDLE_EACH}"
    reader, writer = await asyncio.open_connection(*crowd.server, local_addr=(source, 0))
    with _closing(writer):
        dripping = asyncio.create_task(_drip(writer, number % 2 == 1))
        try:
            crowd.answers[await _status(reader)] += 1
        finally:
            dripping.cancel()
    await asyncio.sleep(_PAUSE)


async def _hang_up(crowd: Crowd, _: int) -> None:
    """Ask for a long search, and go away while it is planned, or before the body's end."""
    rng = np.random.default_rng()
    n = int(rng.integers(10, 500))
    body = json.dumps({"coordinates": rng.random((n, 4)).tolist(), "time_limit": 10}).encode()
    _, writer = await crowd.connect()
    with _closing(writer):
        writer.write(_head(len(body)) + body[: len(body) // (2 if rng.random() < 0.2 else 1)])
        await writer.drain()
        await asyncio.sleep(rng.exponential(0.2))
    crowd.answers["hung up"] += 1


async def _repeat_a_key(crowd: Crowd, _: int) -> None:
    """Fill the queue with jobs, and post one request many times with the same key at once.

    An answer of success must be of a front with tours, or of a job that can be found.
    """
    async with crowd.client() as client:
        jobs = [_post_job(crowd, client, {}) for _ in range(12)]
        await asyncio.gather(*jobs)
        key = {"Idempotency-Key": random.randbytes(8).hex()}
        wait = random.random() < 0.5
        headers = key if wait else {**key, "Prefer": "respond-async"}
        await asyncio.gather(*(_post_job(crowd, client, headers) for _ in range(REPEATS)))


async def _post_job(crowd: Crowd, client: httpx.AsyncClient, headers: dict[str, str]) -> None:
    rows = np.random.default_rng(1).random((30, 4)).tolist()
    request = {**_PLANNED, "coordinates": rows, "time_limit": 0.3}
    answer = await client.post(
        "/front", json=request, headers=headers or {"Prefer": "respond-async"}
    )
    front = crowd.answered(answer)
    if answer.status_code == 200 and not front["front"]:
        crowd.faults.append(f"a front without a tour: {answer.text[:300]}")
    if answer.status_code == 202:
        found = await client.get(f"/front/{front['id']}")
        if found.status_code not in (200, 410, 429, 503):  # the proxy may refuse to ask for it
            crowd.faults.append(f"job {front['id']} is lost: {found.status_code}")


async def _post_hostile(crowd: Crowd, number: int) -> None:
    """Post broken files, JSON, parts and extreme numbers, one after another."""
    rng = random.Random(f"attack {number} {crowd.answers.total()}")
    async with crowd.client() as client:
        for make in (extreme, *GENERATORS.values()) * 5:
            source = make(rng)
            if isinstance(source, TaskSource):
                crowd.answered(await client.post(f"/{source.kind}", **message_of(source)))
            await asyncio.sleep(0.01)


async def _post_lists(crowd: Crowd, _: int) -> None:
    """Post a long body of very many lists, which takes about a second to refuse."""
    bodies = lists()
    body = bodies[crowd.answers.total() % len(bodies)]
    async with crowd.client() as client:
        headers = {"Content-Type": "application/json"}
        answer = await client.post("/front", content=body, headers=headers)
    crowd.answered(answer)
    if answer.status_code == 200:
        crowd.faults.append(f"a body of lists was planned: {body[:60]!r}")
    await asyncio.sleep(_PAUSE)


def _head(length: int) -> bytes:
    return (
        "POST /front HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
        f"Content-Length: {length}\r\n\r\n"
    ).encode()


async def _send(writer: asyncio.StreamWriter, count: int) -> None:
    for _ in range(count // len(_CHUNK)):
        writer.write(_CHUNK)
        await writer.drain()
        await asyncio.sleep(len(_CHUNK) / UPLOAD_RATE)
    writer.write(_CHUNK[: count % len(_CHUNK)])
    await writer.drain()


async def _drip(writer: asyncio.StreamWriter, speaking: bool) -> None:
    for letter in b"GET /health/live HTTP/1.1\r\nX-Slow: " + b"x" * 1000 if speaking else b"":
        writer.write(bytes([letter]))
        await asyncio.sleep(1)


async def _status(reader: asyncio.StreamReader) -> str:
    """Return the status that comes, or that the connection was closed without one."""
    line = await reader.readline()
    return line.split()[1].decode() if line.startswith(b"HTTP/") else "closed"


@contextmanager
def _closing(writer: asyncio.StreamWriter) -> Iterator[None]:
    """Close a connection at the end, and at once."""
    try:
        yield
    finally:
        writer.transport.abort()


CROWDS: Crowds = {
    "stalled uploads": Kind("127.0.0.2", UPLOADS, _stall_an_upload),
    "idle connections": Kind("127.0.0.101", IDLE_ADDRESSES * IDLE_EACH, _be_idle),
    "hang-ups": Kind("127.0.0.3", HANGING_UP, _hang_up),
    "repeats of a key": Kind("127.0.0.4", 1, _repeat_a_key),
    "hostile bodies": Kind("127.0.0.5", HOSTILE, _post_hostile),
    "bodies of lists": Kind("127.0.0.6", LISTS, _post_lists),
}


def attack(server: Server, seconds: float, kinds: Crowds = CROWDS) -> dict[str, dict[str, Any]]:
    """Attack for so long, and return what each crowd was answered, and the faults that it saw."""
    return asyncio.run(_attack(server, time.monotonic() + seconds, kinds))
