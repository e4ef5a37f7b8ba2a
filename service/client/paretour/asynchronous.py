"""The client for asynchronous programs, and its jobs: the same as sync.py, with `await`."""

import asyncio
from collections.abc import AsyncIterator, Callable, Coroutine
from typing import Any, Concatenate, Generic, ParamSpec, Self, TypeVar

import httpx
from paretour.bodies import MOST_BYTES, Body
from paretour.calls import (
    AnyFront,
    Call,
    Calls,
    HttpRequest,
    Parse,
    Submitted,
    address_of,
    client_headers,
)
from paretour.events import JobEvents
from paretour.explaining import described_as
from paretour.kinds import FrontOfAnyKind, parse_any
from paretour.plans import FleetFront, RobotFront, parse_fleet, parse_robots
from paretour.values import Front, Progress, parse_front

P = ParamSpec("P")
T = TypeVar("T")

_AT_ONCE = 8  # the places for one caller of a service with the default queue and one worker
# Calls take turns, so the pool need not: a job that is followed must not hold up a call about it.
_UNLIMITED = httpx.Limits(max_connections=None, max_keepalive_connections=20)


def _result(
    call: Callable[Concatenate[Calls, P], Call[T]],
) -> Callable[Concatenate["AsyncClient", P], Coroutine[Any, Any, T]]:
    """Return the method of the client that makes a call and returns its result."""

    @described_as(call)
    async def method(self: "AsyncClient", *args: P.args, **kwargs: P.kwargs) -> T:
        return await self._connection.run(call(self._calls, *args, **kwargs))

    return method


def _job(
    call: Callable[Concatenate[Calls, P], Call[Submitted[AnyFront]]],
) -> Callable[Concatenate["AsyncClient", P], Coroutine[Any, Any, "AsyncJob[AnyFront]"]]:
    """Return the method of the client that submits a job and returns it."""

    @described_as(call)
    async def method(
        self: "AsyncClient", *args: P.args, **kwargs: P.kwargs
    ) -> "AsyncJob[AnyFront]":
        submitted = await self._connection.run(call(self._calls, *args, **kwargs))
        return AsyncJob(*submitted, self._connection, self._calls)

    return method


class AsyncClient:
    """A client of the service at a URL. As a context manager it closes its connections.

    Arguments are those of Client; `transport` is an asynchronous one.

    Any number of calls may be gathered: those beyond the first eight wait for their turn, which
    counts neither as timeout nor as patience.

    Raises:
        Refused: Any call may raise it: the service answered with an error.
        UnexpectedAnswer: Any call may raise it: the answer is not one of this service.
        httpx.TransportError: Any call may raise it: there was no answer.
    """

    def __init__(
        self,
        url: str,
        *,
        api_key: str | None = None,
        timeout: float = 30.0,
        patience: float = 60.0,
        most_bytes: int = MOST_BYTES,
        transport: httpx.AsyncBaseTransport | None = None,
    ) -> None:
        http = httpx.AsyncClient(
            base_url=address_of(url),
            headers=client_headers(api_key),
            limits=_UNLIMITED,
            transport=transport,
        )
        self._connection = _Connection(http, most_bytes)
        self._calls = Calls(timeout=timeout, patience=patience)

    front = _result(Calls.front)
    coverage = _result(Calls.coverage)
    replan = _result(Calls.replan)
    replan_fleet = _result(Calls.replan_fleet)
    offers = _result(Calls.offers)
    fleet = _result(Calls.fleet)
    robots = _result(Calls.robots)
    plan = _result(Calls.plan)
    plan_any = _result(Calls.plan_any)
    plan_fleet = _result(Calls.plan_fleet)
    plan_robots = _result(Calls.plan_robots)
    tour = _result(Calls.tour)
    ask = _result(Calls.ask)
    geojson = _result(Calls.geojson)
    read_files = _result(Calls.read_files)
    fronts = _result(Calls.fronts)
    actors = _result(Calls.actors)
    submit = _job(Calls.submit)
    submit_coverage = _job(Calls.submit_coverage)
    submit_replan = _job(Calls.submit_replan)
    submit_replan_fleet = _job(Calls.submit_replan_fleet)
    submit_fleet = _job(Calls.submit_fleet)
    submit_robots = _job(Calls.submit_robots)
    post = _job(Calls.post)

    def job(self, front: str) -> "AsyncJob[Front]":
        """Return the job of a front by its id, without asking whether the service knows it."""
        return AsyncJob(front, parse_front, self._connection, self._calls)

    def fleet_job(self, front: str) -> "AsyncJob[FleetFront]":
        """Return the job of a front of plans for a fleet, as `job` does."""
        return AsyncJob(front, parse_fleet, self._connection, self._calls)

    def robots_job(self, front: str) -> "AsyncJob[RobotFront]":
        """Return the job of a front of plans for several robots, as `job` does."""
        return AsyncJob(front, parse_robots, self._connection, self._calls)

    def any_job(self, front: str) -> "AsyncJob[FrontOfAnyKind]":
        """Return the job of a front whose kind is not known, as `job` does."""
        return AsyncJob(front, parse_any, self._connection, self._calls)

    async def close(self) -> None:
        """Close the connections."""
        await self._connection.close()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()


class AsyncJob(Generic[AnyFront]):
    """A front, of tours or of plans, that is planned while the program does something else.

    Attributes:
        id: The id of the front.
    """

    def __init__(
        self, front_id: str, parse: Parse[AnyFront], connection: "_Connection", calls: Calls
    ) -> None:
        self.id = front_id
        self._parse: Parse[AnyFront] = parse
        self._connection = connection
        self._calls = calls

    def progress(self) -> AsyncIterator[Progress]:
        """Yield the progress of the search until the job ends."""
        return self._connection.follow(self._calls.events(self.id))

    async def front(self) -> AnyFront:
        """Return the best front so far."""
        return await self._connection.run(self._calls.stored(self.id, self._parse))

    async def result(self) -> AnyFront:
        """Wait for the job to end and return its front.

        Raises:
            Refused: The job failed.
        """
        async for _ in self.progress():
            pass
        return await self._connection.run(self._calls.result(self.id, self._parse))

    async def cancel(self) -> AnyFront:
        """End the job now and return the best front so far."""
        return await self._connection.run(self._calls.cancel(self.id, self._parse))

    async def forget(self) -> None:
        """Delete the front of a job that has ended from the service."""
        await self._connection.run(self._calls.forget(self.id))


class _Connection:
    """An httpx.AsyncClient that runs calls and follows jobs."""

    def __init__(self, http: httpx.AsyncClient, most_bytes: int) -> None:
        self._http = http
        self._most_bytes = most_bytes
        self._to_plan, self._to_ask = asyncio.Semaphore(_AT_ONCE), asyncio.Semaphore(_AT_ONCE)
        self.close = http.aclose

    async def run(self, call: Call[T]) -> T:
        """Run a call when it is its turn, which it keeps while the service has it wait.

        What asks about a job, or cancels it, does not wait for searches to end.
        """
        request = next(call)
        async with self._to_plan if request.method == "POST" else self._to_ask:
            return await self._run(call, request)

    async def _run(self, call: Call[T], request: HttpRequest) -> T:
        while True:
            await asyncio.sleep(request.delay)
            async with self._http.stream(**request.arguments) as streamed:
                response = await self._read(streamed, request.timeout)
            try:
                request = call.send(response)
            except StopIteration as finished:
                return finished.value

    async def follow(self, events: JobEvents) -> AsyncIterator[Progress]:
        while not events.ended:
            await asyncio.sleep(events.delay)
            try:
                async with self._http.stream(**events.arguments) as response:
                    if not response.is_success:
                        events.retry_refusal(await self._read(response, events.timeout))
                        continue
                    events.begin(response)
                    async for chunk in _chunks(response):
                        for progress in events.read(chunk):
                            yield progress
                events.finish()
            except httpx.TransportError as error:
                events.retry_error(error)

    async def _read(self, response: httpx.Response, seconds: float) -> httpx.Response:
        body = Body(response, self._most_bytes, seconds)
        async for chunk in _chunks(response):
            body.feed(chunk)
        return body.response()


async def _chunks(response: httpx.Response) -> AsyncIterator[bytes]:
    """Yield the body as it comes, or the content of a body that was already read."""
    if response.is_stream_consumed:
        yield response.content
    else:
        async for chunk in response.aiter_raw():
            yield chunk
