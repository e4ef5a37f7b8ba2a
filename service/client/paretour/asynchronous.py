"""The client for programs that await."""

import asyncio
from collections.abc import AsyncIterator
from typing import Self, TypeVar, Unpack

import httpx
from httpx_sse import aconnect_sse
from paretour.calls import Call, Calls, identity
from paretour.events import Following
from paretour.requests import Plan, coverage_plan, front_plan
from paretour.values import Actor, CoverageRequest, Front, FrontRequest, Progress, Tour

T = TypeVar("T")


class AsyncClient:
    """A service at a URL; also a context manager that closes its connections.

    Arguments are those of Client, `transport` one that awaits.

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
        transport: httpx.AsyncBaseTransport | None = None,
    ) -> None:
        http = httpx.AsyncClient(base_url=url, headers=identity(api_key), transport=transport)
        self._driver = _Driver(http)
        self._calls = Calls(timeout=timeout, patience=patience)

    async def front(self, **request: Unpack[FrontRequest]) -> Front:
        """The front of the cities, once its time limit is over or nothing more is found."""
        return await self.plan(front_plan(request))

    async def coverage(self, png: bytes | None = None, **request: Unpack[CoverageRequest]) -> Front:
        """The front of the places on a map, the content of a PNG file unless it is the grid."""
        return await self.plan(coverage_plan(request, png))

    async def submit(self, **request: Unpack[FrontRequest]) -> "AsyncJob":
        """Have a front planned without waiting for it."""
        return await self.post(front_plan(request))

    async def submit_coverage(
        self, png: bytes | None = None, **request: Unpack[CoverageRequest]
    ) -> "AsyncJob":
        """Have places on a map planned without waiting for it."""
        return await self.post(coverage_plan(request, png))

    async def plan(self, plan: Plan) -> Front:
        """The front of whatever a plan says."""
        return await self._driver.make(self._calls.plan(plan))

    async def post(self, plan: Plan) -> "AsyncJob":
        """Have whatever a plan says planned without waiting for it."""
        return self.job(await self._driver.make(self._calls.submit(plan)))

    def job(self, front: str) -> "AsyncJob":
        """The job that plans, or planned, the front with this id."""
        return AsyncJob(front, self._driver, self._calls)

    async def tour(self, angle: float, front: str | None = None) -> Tour:
        """The tour nearest to an angle in degrees, of a front by its id, or of the latest."""
        return await self._driver.make(self._calls.tour(angle, front))

    async def actors(self) -> tuple[Actor, ...]:
        """The networks to choose from."""
        return await self._driver.make(self._calls.actors())

    async def close(self) -> None:
        """Close its connections."""
        await self._driver.close()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()


class AsyncJob:
    """A front that is planned while the program does something else; `id` is the front's."""

    def __init__(self, front: str, driver: "_Driver", calls: Calls) -> None:
        self.id = front
        self._driver = driver
        self._calls = calls

    def progress(self) -> AsyncIterator[Progress]:
        """How far the search has come, again and again until it ends."""
        return self._driver.follow(self._calls.following(self.id))

    async def front(self) -> Front:
        """The best front so far."""
        return await self._driver.make(self._calls.stored(self.id))

    async def result(self) -> Front:
        """The front, once the job has ended. A job that failed raises Refused."""
        async for _ in self.progress():
            pass
        return await self._driver.make(self._calls.result(self.id))

    async def cancel(self) -> Front:
        """End the job now; the best front so far."""
        return await self._driver.make(self._calls.cancel(self.id))

    async def forget(self) -> None:
        """Have the service forget a front whose job has ended."""
        await self._driver.make(self._calls.forget(self.id))


class _Driver:
    """Carries calls over connections, one after the other."""

    def __init__(self, http: httpx.AsyncClient) -> None:
        self._http = http
        self.close = http.aclose

    async def make(self, call: Call[T]) -> T:
        ask = next(call)
        while True:
            await asyncio.sleep(ask.after)
            answer = await self._http.request(**ask.request)
            try:
                ask = call.send(answer)
            except StopIteration as made:
                return made.value

    async def follow(self, following: Following) -> AsyncIterator[Progress]:
        while not following.ended:
            await asyncio.sleep(following.pause)
            try:
                async with aconnect_sse(self._http, **following.request) as source:
                    if source.response.is_error:
                        await source.response.aread()
                        following.turned_away(source.response)
                        continue
                    async for event in source.aiter_sse():
                        if (progress := following.hear(event)) is not None:
                            yield progress
                following.closed()
            except httpx.TransportError as error:
                following.broke(error)
