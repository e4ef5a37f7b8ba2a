"""Every call, without its way over the network.

A call is a generator: it yields what to ask, is sent the answer, and returns what was called for.
A driver, which waits or awaits, is all that it takes to make one.
"""

from collections.abc import Generator, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import httpx
from paretour.errors import ASK_AGAIN, Refused, pause_before_next, refusal
from paretour.events import Following
from paretour.requests import Plan
from paretour.values import FINAL, Actor, Front, Tour, front_of, tour_of

T = TypeVar("T")


@dataclass(frozen=True)
class Ask:
    """What to ask, how many seconds to wait for the answer, and how many before asking."""

    method: str
    path: str
    said: Mapping[str, Any]
    timeout: float
    after: float = 0.0

    @property
    def request(self) -> dict[str, Any]:
        """What httpx is told of it."""
        return {"method": self.method, "url": self.path, "timeout": self.timeout, **self.said}


Call = Generator[Ask, httpx.Response, T]


@dataclass(frozen=True, kw_only=True)
class Calls:
    """The calls of a client that waits `timeout` seconds for an answer, beside the search's own.

    Where the service asks to be asked again later (429, 503), it waits for `patience` seconds in
    all before it raises the refusal.
    """

    timeout: float
    patience: float

    def plan(self, plan: Plan) -> Call[Front]:
        """Have a front planned, and wait for it."""
        return front_of((yield from self._post(plan, self.timeout + plan.seconds)).json())

    def submit(self, plan: Plan) -> Call[str]:
        """Have a front planned; the job's id."""
        answer = yield from self._post(plan, self.timeout, Prefer="respond-async")
        return answer.json()["id"]

    def stored(self, front: str) -> Call[Front]:
        """A front as it is by now."""
        return front_of((yield from self._get(_path(front))).json())

    def result(self, front: str) -> Call[Front]:
        """A front that is final, or the refusal that it failed with."""
        answer = yield from self._get(_path(front))
        if answer.json()["status"] == "failed":
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
        return (yield from self._ask(Ask("GET", path, {"params": params}, timeout=self.timeout)))

    def _delete(self, front: str) -> Ask:
        return Ask("DELETE", _path(front), {}, timeout=self.timeout)

    def _post(self, plan: Plan, timeout: float, **headers: str) -> Call[httpx.Response]:
        body = plan.body
        said = {**body, "headers": {**body.get("headers", {}), **headers}}
        return (yield from self._ask(Ask("POST", plan.path, said, timeout=timeout)))


def identity(api_key: str | None) -> dict[str, str]:
    """The headers that say who asks."""
    return {} if api_key is None else {"Authorization": f"Bearer {api_key}"}


def _path(front: str) -> str:
    return f"/front/{front}"
