"""The client for synchronous programs, and its jobs."""

import time
from collections.abc import Callable, Iterator
from typing import Concatenate, Generic, ParamSpec, Self, TypeVar

import httpx
from paretour.bodies import MOST_BYTES, Body
from paretour.calls import AnyFront, Call, Calls, Parse, Submitted, address_of, client_headers
from paretour.events import JobEvents
from paretour.explaining import described_as
from paretour.kinds import FrontOfAnyKind, parse_any
from paretour.plans import FleetFront, RobotFront, parse_fleet, parse_robots
from paretour.values import Front, Progress, parse_front

P = ParamSpec("P")
T = TypeVar("T")


def _result(
    call: Callable[Concatenate[Calls, P], Call[T]],
) -> Callable[Concatenate["Client", P], T]:
    """Return the method of the client that makes a call and returns its result."""

    @described_as(call)
    def method(self: "Client", *args: P.args, **kwargs: P.kwargs) -> T:
        return self._connection.run(call(self._calls, *args, **kwargs))

    return method


def _job(
    call: Callable[Concatenate[Calls, P], Call[Submitted[AnyFront]]],
) -> Callable[Concatenate["Client", P], "Job[AnyFront]"]:
    """Return the method of the client that submits a job and returns it."""

    @described_as(call)
    def method(self: "Client", *args: P.args, **kwargs: P.kwargs) -> "Job[AnyFront]":
        submitted = self._connection.run(call(self._calls, *args, **kwargs))
        return Job(*submitted, self._connection, self._calls)

    return method


class Client:
    """A client of the service at a URL. As a context manager it closes its connections.

    Args:
        url: The address of the service.
        api_key: The API key, if the service requires one.
        timeout: Seconds to wait for a response, beyond those that the search may take.
        patience: Seconds, in all, to wait and retry a call when the service asks for it (429, 503)
            before Refused is raised.
        most_bytes: The most bytes that an answer may have, decompressed.
        transport: A transport of httpx in place of the network.

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
        transport: httpx.BaseTransport | None = None,
    ) -> None:
        headers = client_headers(api_key)
        http = httpx.Client(base_url=address_of(url), headers=headers, transport=transport)
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

    def job(self, front: str) -> "Job[Front]":
        """Return the job of a front by its id, without asking whether the service knows it."""
        return Job(front, parse_front, self._connection, self._calls)

    def fleet_job(self, front: str) -> "Job[FleetFront]":
        """Return the job of a front of plans for a fleet, as `job` does."""
        return Job(front, parse_fleet, self._connection, self._calls)

    def robots_job(self, front: str) -> "Job[RobotFront]":
        """Return the job of a front of plans for several robots, as `job` does."""
        return Job(front, parse_robots, self._connection, self._calls)

    def any_job(self, front: str) -> "Job[FrontOfAnyKind]":
        """Return the job of a front whose kind is not known, as `job` does."""
        return Job(front, parse_any, self._connection, self._calls)

    def close(self) -> None:
        """Close the connections."""
        self._connection.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Job(Generic[AnyFront]):
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

    def progress(self) -> Iterator[Progress]:
        """Yield the progress of the search until the job ends."""
        return self._connection.follow(self._calls.events(self.id))

    def front(self) -> AnyFront:
        """Return the best front so far."""
        return self._connection.run(self._calls.stored(self.id, self._parse))

    def result(self) -> AnyFront:
        """Wait for the job to end and return its front.

        Raises:
            Refused: The job failed.
        """
        for _ in self.progress():
            pass
        return self._connection.run(self._calls.result(self.id, self._parse))

    def cancel(self) -> AnyFront:
        """End the job now and return the best front so far."""
        return self._connection.run(self._calls.cancel(self.id, self._parse))

    def forget(self) -> None:
        """Delete the front of a job that has ended from the service."""
        self._connection.run(self._calls.forget(self.id))


class _Connection:
    """An httpx.Client that runs calls and follows jobs."""

    def __init__(self, http: httpx.Client, most_bytes: int) -> None:
        self._http = http
        self._most_bytes = most_bytes
        self.close = http.close

    def run(self, call: Call[T]) -> T:
        request = next(call)
        while True:
            time.sleep(request.delay)
            with self._http.stream(**request.arguments) as streamed:
                response = self._read(streamed, request.timeout)
            try:
                request = call.send(response)
            except StopIteration as finished:
                return finished.value

    def follow(self, events: JobEvents) -> Iterator[Progress]:
        while not events.ended:
            time.sleep(events.delay)
            try:
                with self._http.stream(**events.arguments) as response:
                    if not response.is_success:
                        events.retry_refusal(self._read(response, events.timeout))
                        continue
                    events.begin(response)
                    for chunk in _chunks(response):
                        yield from events.read(chunk)
                events.finish()
            except httpx.TransportError as error:
                events.retry_error(error)

    def _read(self, response: httpx.Response, seconds: float) -> httpx.Response:
        body = Body(response, self._most_bytes, seconds)
        for chunk in _chunks(response):
            body.feed(chunk)
        return body.response()


def _chunks(response: httpx.Response) -> Iterator[bytes]:
    """Yield the body as it comes, or the content of a body that was already read."""
    if response.is_stream_consumed:
        yield response.content
    else:
        yield from response.iter_raw()
