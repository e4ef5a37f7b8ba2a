"""Visitors of every kind: patient ones, clumsy ones, and those who hang up."""

import http.client
import json
import socket
import threading
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

FINAL = ("done", "cancelled", "failed")
_PATIENCE = 120.0  # seconds after which a job is given up for lost
_PAUSE = 0.2  # of a visitor that was refused, and between two looks at a job
_BAD = (
    b"",
    b"[" * 100_000,
    b"{}",
    b'{"coordinates": [[0, 0, 0]]}',
    b'{"coordinates": [[0, 0, 0, NaN]]}',
    b'{"coordinates": [[0, 0, 0, 1e308]]}',
    b'{"coordinates": [[0, 0, 0, 0]], "matrices": []}',
    b'{"coordinates": "' + b"x" * 1_000_000 + b'"}',
    b'{"coordinates": [' + b"[0, 0, 0, 0]," * 2000 + b"[0, 0, 0, 0]]}",
)


class Tally:
    """What all visitors saw."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._answers: defaultdict[str, Counter[str]] = defaultdict(Counter)
        self._jobs: Counter[str] = Counter()
        self.faults: list[str] = []

    @property
    def answers(self) -> dict[str, dict[str, int]]:
        """How often each status was the answer to each deed."""
        return {deed: dict(statuses) for deed, statuses in self._answers.items()}

    @property
    def jobs(self) -> dict[str, int]:
        """How many jobs were accepted, and how they ended."""
        return dict(self._jobs)

    def answered(self, deed: str, status: int, content: bytes) -> None:
        """Note an answer. Every fault of the service is one, but that it is full is none."""
        with self._lock:
            self._answers[deed][str(status)] += 1
            if status >= 500 and status != 503:
                self.faults.append(f"{deed}: {status} {content[:300].decode(errors='replace')}")

    def job(self, event: str) -> None:
        """Note that a job was accepted, or how it ended."""
        with self._lock:
            self._jobs[event] += 1

    def fault(self, sentence: str) -> None:
        """Note what must never happen."""
        with self._lock:
            self.faults.append(sentence)


class Visitor:
    """Does one thing after another, drawn by chance."""

    def __init__(self, address: tuple[str, int], tally: Tally, seed: int) -> None:
        self._address = address
        self._tally = tally
        self._rng = np.random.default_rng(seed)
        self._deeds: list[tuple[float, Callable[[], None]]] = [
            (0.35, self._plan),
            (0.15, self._misuse),
            (0.10, self._hang_up),
            (0.15, self._wait_for_a_job),
            (0.10, self._cancel_a_job),
            (0.05, self._watch_a_job),
            (0.10, self._look_around),
        ]

    def visit(self, until: float) -> None:
        """Do things until then; what was begun is ended."""
        shares, deeds = zip(*self._deeds, strict=True)
        while time.monotonic() < until:
            deed = deeds[self._rng.choice(len(deeds), p=shares)]
            try:
                deed()
            except (OSError, http.client.HTTPException) as error:
                self._tally.fault(f"{deed.__name__}: {error!r}")

    def _plan(self) -> None:
        self._ask("plan", "POST", "/front", self._request())

    def _misuse(self) -> None:
        self._ask("misuse", "POST", "/front", _BAD[self._rng.integers(len(_BAD))])

    def _look_around(self) -> None:
        paths = ("/actors", "/health/ready", "/metrics", "/tour?angle=30", "/front/none")
        self._ask("look around", "GET", paths[self._rng.integers(len(paths))])

    def _hang_up(self) -> None:
        """Before the body's end, or while the front is planned."""
        body = self._request()
        cut = len(body) // 2 if self._rng.random() < 0.3 else len(body)
        head = f"POST /front HTTP/1.1\r\nHost: x\r\nContent-Length: {len(body)}\r\n"
        with socket.create_connection(self._address, timeout=_PATIENCE) as connection:
            connection.sendall(f"{head}Content-Type: application/json\r\n\r\n".encode())
            connection.sendall(body[:cut])
            time.sleep(self._rng.exponential(0.1))
        self._tally.answered("hang up", 0, b"")

    def _wait_for_a_job(self) -> None:
        if job := self._order("wait for a job"):
            self._see_to_the_end(job)

    def _cancel_a_job(self) -> None:
        if job := self._order("cancel a job"):
            time.sleep(self._rng.exponential(0.3))
            status, _ = self._ask("cancel a job", "DELETE", f"/front/{job}")
            if status == 200:
                self._see_to_the_end(job)
            elif status == 204:
                self._tally.job("forgotten once done")
            else:
                self._tally.fault(f"job {job}: DELETE was answered with {status}")

    def _watch_a_job(self) -> None:
        if job := self._order("watch a job"):
            status, content = self._ask("watch a job", "GET", f"/front/{job}/events")
            if status != 200 or not any(final in content.decode() for final in FINAL):
                self._tally.fault(f"job {job}: its events ended with {content[-200:]!r}")
            self._see_to_the_end(job)

    def _order(self, deed: str) -> str | None:
        """The id of a job that was accepted."""
        headers = {"Prefer": "respond-async"}
        status, content = self._ask(deed, "POST", "/front", self._request(), headers)
        if status != 202:
            return None
        self._tally.job("accepted")
        return str(json.loads(content)["id"])

    def _see_to_the_end(self, job: str) -> None:
        deadline = time.monotonic() + _PATIENCE
        while time.monotonic() < deadline:
            status, content = self._ask("look at a job", "GET", f"/front/{job}")
            front = json.loads(content)
            if status != 200:
                self._tally.fault(f"job {job} is lost: {status} {front}")
                return
            if front["status"] in FINAL:
                self._tally.job(front["status"])
                return
            time.sleep(_PAUSE)
        self._tally.fault(f"job {job} has not ended after {_PATIENCE} s")

    def _ask(
        self,
        deed: str,
        method: str,
        path: str,
        body: bytes | None = None,
        headers: dict[str, str] | None = None,
    ) -> tuple[int, bytes]:
        given = {} if body is None else {"Content-Type": "application/json"}
        with self._connected() as connection:
            connection.request(method, path, body, {**given, **(headers or {})})
            answer = connection.getresponse()
            content = answer.read()
        self._tally.answered(deed, answer.status, content)
        if answer.status == 503:
            time.sleep(_PAUSE)
        return answer.status, content

    @contextmanager
    def _connected(self) -> Iterator[http.client.HTTPConnection]:
        connection = http.client.HTTPConnection(*self._address, timeout=_PATIENCE)
        try:
            yield connection
        finally:
            connection.close()

    def _request(self) -> bytes:
        n = int(np.exp(self._rng.uniform(np.log(10), np.log(500))))
        request: dict[str, Any] = {
            "coordinates": self._rng.random((n, 4)).tolist(),
            "preferences": int(self._rng.integers(1, 101)),
            "time_limit": float(self._rng.choice([0.0, 0.1, 0.5, 1.0])),
            "size": int(self._rng.integers(1, 101)),
        }
        return json.dumps(request).encode()
