"""The client for programs that wait."""

import time
from collections.abc import Iterator
from typing import Self, TypeVar, Unpack

import httpx
from httpx_sse import connect_sse
from paretour.calls import Call, Calls, identity
from paretour.events import Following
from paretour.requests import Plan, coverage_plan, front_plan
from paretour.values import Actor, CoverageRequest, Front, FrontRequest, Progress, Tour

T = TypeVar("T")


class Client:
    """A service at a URL; also a context manager that closes its connections.

    Args:
        url: Where the service answers.
        api_key: For a service that asks for one.
        timeout: Seconds to wait for an answer, beyond the time limit of what was asked.
        patience: Seconds, in all, to wait and ask again where the service says later (429, 503).
        transport: What carries requests instead of the network.

    Raises:
        Refused: by any call, where the service did not do what was asked.
        httpx.TransportError: by any call, where there was no answer.
    """

    def __init__(
        self,
        url: str,
        *,
        api_key: str | None = None,
        timeout: float = 30.0,
        patience: float = 60.0,
        transport: httpx.BaseTransport | None = None,
    ) -> None:
        http = httpx.Client(base_url=url, headers=identity(api_key), transport=transport)
        self._driver = _Driver(http)
        self._calls = Calls(timeout=timeout, patience=patience)

    def front(self, **request: Unpack[FrontRequest]) -> Front:
        """The front of the cities, once its time limit is over or nothing more is found."""
        return self.plan(front_plan(request))

    def coverage(self, png: bytes | None = None, **request: Unpack[CoverageRequest]) -> Front:
        """The front of the places on a map, the content of a PNG file unless it is the grid."""
        return self.plan(coverage_plan(request, png))

    def submit(self, **request: Unpack[FrontRequest]) -> "Job":
        """Have a front planned without waiting for it."""
        return self.post(front_plan(request))

    def submit_coverage(
        self, png: bytes | None = None, **request: Unpack[CoverageRequest]
    ) -> "Job":
        """Have places on a map planned without waiting for it."""
        return self.post(coverage_plan(request, png))

    def plan(self, plan: Plan) -> Front:
        """The front of whatever a plan says."""
        return self._driver.make(self._calls.plan(plan))

    def post(self, plan: Plan) -> "Job":
        """Have whatever a plan says planned without waiting for it."""
        return self.job(self._driver.make(self._calls.submit(plan)))

    def job(self, front: str) -> "Job":
        """The job that plans, or planned, the front with this id."""
        return Job(front, self._driver, self._calls)

    def tour(self, angle: float, front: str | None = None) -> Tour:
        """The tour nearest to an angle in degrees, of a front by its id, or of the latest."""
        return self._driver.make(self._calls.tour(angle, front))

    def actors(self) -> tuple[Actor, ...]:
        """The networks to choose from."""
        return self._driver.make(self._calls.actors())

    def close(self) -> None:
        """Close its connections."""
        self._driver.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Job:
    """A front that is planned while the program does something else; `id` is the front's."""

    def __init__(self, front: str, driver: "_Driver", calls: Calls) -> None:
        self.id = front
        self._driver = driver
        self._calls = calls

    def progress(self) -> Iterator[Progress]:
        """How far the search has come, again and again until it ends."""
        return self._driver.follow(self._calls.following(self.id))

    def front(self) -> Front:
        """The best front so far."""
        return self._driver.make(self._calls.stored(self.id))

    def result(self) -> Front:
        """The front, once the job has ended. A job that failed raises Refused."""
        for _ in self.progress():
            pass
        return self._driver.make(self._calls.result(self.id))

    def cancel(self) -> Front:
        """End the job now; the best front so far."""
        return self._driver.make(self._calls.cancel(self.id))

    def forget(self) -> None:
        """Have the service forget a front whose job has ended."""
        self._driver.make(self._calls.forget(self.id))


class _Driver:
    """Carries calls over connections, one after the other."""

    def __init__(self, http: httpx.Client) -> None:
        self._http = http
        self.close = http.close

    def make(self, call: Call[T]) -> T:
        ask = next(call)
        while True:
            time.sleep(ask.after)
            answer = self._http.request(**ask.request)
            try:
                ask = call.send(answer)
            except StopIteration as made:
                return made.value

    def follow(self, following: Following) -> Iterator[Progress]:
        while not following.ended:
            time.sleep(following.pause)
            try:
                with connect_sse(self._http, **following.request) as source:
                    if source.response.is_error:
                        source.response.read()
                        following.turned_away(source.response)
                        continue
                    for event in source.iter_sse():
                        if (progress := following.hear(event)) is not None:
                            yield progress
                following.closed()
            except httpx.TransportError as error:
                following.broke(error)
