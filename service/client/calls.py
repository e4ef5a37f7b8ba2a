"""Every call, without its way over the network.

A call is a generator: it yields what to ask, is sent the answer, and returns what was called for.
A driver, which waits or awaits, is all that it takes to make one.
"""

import json
from collections.abc import Generator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import httpx

from service.client.following import Following
from service.client.refused import ASK_AGAIN, Refused, pause_before_next, refusal
from service.client.values import FINAL, Actor, Front, FrontRequest, Tour, front_of, tour_of

T = TypeVar("T")
_USUAL_TIME_LIMIT = 1.0  # what the service takes where a request says nothing
_BOUND_SECONDS = 5.0  # what it takes at most to prove a bound


@dataclass(frozen=True, kw_only=True)
class Ask:
    """What to ask, how many seconds from now, and how many seconds to wait for the answer."""

    method: str
    path: str
    content: bytes | None = None
    params: Mapping[str, Any] | None = None
    headers: Mapping[str, str] = field(default_factory=dict)
    timeout: float
    after: float = 0.0

    @property
    def request(self) -> dict[str, Any]:
        """What httpx is told of it."""
        return {
            "method": self.method,
            "url": self.path,
            "content": self.content,
            "params": self.params,
            "headers": self.headers,
            "timeout": self.timeout,
        }


Call = Generator[Ask, httpx.Response, T]


@dataclass(frozen=True, kw_only=True)
class Calls:
    """The calls of a client that waits `timeout` seconds for an answer, beside the search's own.

    Where the service asks to be asked again later (429, 503), it waits for `patience` seconds in
    all before it raises the refusal.
    """

    timeout: float
    patience: float

    def front(self, request: FrontRequest) -> Call[Front]:
        """Plan a front and wait for it."""
        return front_of((yield from self._ask(self._plan(request))).json())

    def submit(self, request: FrontRequest) -> Call[str]:
        """Have a front planned; the job's id."""
        ask = replace(self._plan(request), timeout=self.timeout)
        ask = replace(ask, headers={**ask.headers, "Prefer": "respond-async"})
        return (yield from self._ask(ask)).json()["id"]

    def stored(self, front: str) -> Call[Front]:
        """A front as it is by now."""
        return front_of((yield from self._get(_path(front))).json())

    def result(self, front: str) -> Call[Front]:
        """A front that is final, or the refusal that it failed with."""
        answer = yield from self._get(_path(front))
        if answer.json().get("status") == "failed":
            raise Refused(answer.json()["problem"])
        return front_of(answer.json())

    def cancel(self, front: str) -> Call[Front]:
        """The front as its job ended, or the best so far of one that ended just now."""
        found = yield from self.stored(front)
        if found.status in FINAL:  # where deleting would forget it
            return found
        answer = yield from self._ask(self._delete(front))
        return found if answer.status_code == httpx.codes.NO_CONTENT else front_of(answer.json())

    def forget(self, front: str) -> Call[None]:
        """Have a front that is final forgotten."""
        yield from self._ask(self._delete(front))

    def tour(self, angle: float, front: str | None) -> Call[Tour]:
        """The tour nearest to an angle, of one front or of the latest."""
        params = {"angle": angle} if front is None else {"angle": angle, "front": front}
        return tour_of((yield from self._get("/tour", params)).json())

    def actors(self) -> Call[tuple[Actor, ...]]:
        """The networks to choose from."""
        answer = yield from self._get("/actors")
        return tuple(Actor(**facts) for facts in answer.json()["actors"])

    def following(self, front: str) -> Following:
        """How to follow a job's progress."""
        return Following(front, self.timeout, self.patience)

    def _ask(self, ask: Ask) -> Call[httpx.Response]:
        waited = 0.0
        while (answer := (yield ask)).status_code in ASK_AGAIN:
            ask = replace(ask, after=pause_before_next(answer))
            waited += ask.after
            if waited > self.patience:
                break
        if answer.is_success:
            return answer
        raise refusal(answer)

    def _get(self, path: str, params: Mapping[str, Any] | None = None) -> Call[httpx.Response]:
        ask = Ask(method="GET", path=path, params=params, timeout=self.timeout)
        return (yield from self._ask(ask))

    def _delete(self, front: str) -> Ask:
        return Ask(method="DELETE", path=_path(front), timeout=self.timeout)

    def _plan(self, request: FrontRequest) -> Ask:
        search = request.get("time_limit", _USUAL_TIME_LIMIT)
        bound = _BOUND_SECONDS if request.get("bound") else 0.0
        return Ask(
            method="POST",
            path="/front",
            content=json.dumps(request, default=_plain).encode(),
            headers={"Content-Type": "application/json"},
            timeout=self.timeout + search + bound,
        )


def identity(api_key: str | None) -> dict[str, str]:
    """The headers that say who asks."""
    return {} if api_key is None else {"Authorization": f"Bearer {api_key}"}


def _path(front: str) -> str:
    return f"/front/{front}"


def _plain(array: Any) -> Any:
    """What JSON has for an array, or for a number of one."""
    return array.tolist()
