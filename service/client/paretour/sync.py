"""The client for synchronous programs, and its jobs."""

import time
from collections.abc import Iterator
from typing import Any, Generic, Self, TypeVar, Unpack

import httpx
from paretour.bodies import MOST_BYTES, Body
from paretour.calls import AnyFront, Call, Calls, Geometry, Parse, client_headers
from paretour.choice import Choice
from paretour.events import JobEvents
from paretour.fleets import FleetFront, parse_fleet
from paretour.kinds import FrontOfAnyKind, parse_any
from paretour.members import (
    CoverageRequest,
    FleetRequest,
    FrontRequest,
    ReplanRequest,
    RobotsRequest,
)
from paretour.requests import Plan, coverage_plan, fleet_plan, front_plan, replan_plan
from paretour.robots import RobotFront, parse_robots
from paretour.values import Actor, Front, Progress, Tour, parse_front

T = TypeVar("T")


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
        http = httpx.Client(base_url=url, headers=client_headers(api_key), transport=transport)
        self._connection = _Connection(http, most_bytes)
        self._calls = Calls(timeout=timeout, patience=patience)

    def front(self, **request: Unpack[FrontRequest]) -> Front:
        """Plan a front and wait for it, until its time limit or until nothing more is found."""
        return self.plan(front_plan(request))

    def coverage(self, png: bytes | None = None, **request: Unpack[CoverageRequest]) -> Front:
        """Plan a front over a map and wait for it.

        Args:
            png: The map as the content of a PNG or PGM file, instead of a grid in the request;
                `read_ros_map` reads both from a map.yaml.
            **request: The members of the request.
        """
        return self.plan(coverage_plan(request, png))

    def replan(self, front: Front | str, **request: Unpack[ReplanRequest]) -> Front:
        """Plan the rest of a tour that is being driven, given what has changed, and wait for it.

        Args:
            front: The front, or its id.
            **request: What has changed, and the options of the new front.
        """
        return self.plan(replan_plan(front, request))

    def submit_replan(self, front: Front | str, **request: Unpack[ReplanRequest]) -> "Job[Front]":
        """Submit a job that plans the rest of a tour; arguments as of `replan`."""
        return self.post(replan_plan(front, request))

    def fleet(self, **request: Unpack[FleetRequest]) -> FleetFront:
        """Plan a front of plans for a fleet and wait for it."""
        return self.plan_fleet(fleet_plan(request))

    def submit_fleet(self, **request: Unpack[FleetRequest]) -> "Job[FleetFront]":
        """Submit a job that plans a front of plans for a fleet."""
        return self.fleet_job(self._connection.run(self._calls.submit(fleet_plan(request))))

    def robots(self, png: bytes | None = None, **request: Unpack[RobotsRequest]) -> RobotFront:
        """Plan a front of plans for several robots that share a map; arguments as of `coverage`."""
        return self.plan_robots(coverage_plan(request, png))

    def submit_robots(
        self, png: bytes | None = None, **request: Unpack[RobotsRequest]
    ) -> "Job[RobotFront]":
        """Submit a job that plans for several robots; arguments as of `coverage`."""
        submitted = self._calls.submit(coverage_plan(request, png))
        return self.robots_job(self._connection.run(submitted))

    def submit(self, **request: Unpack[FrontRequest]) -> "Job[Front]":
        """Submit a job that plans a front."""
        return self.post(front_plan(request))

    def submit_coverage(
        self, png: bytes | None = None, **request: Unpack[CoverageRequest]
    ) -> "Job[Front]":
        """Submit a job that plans a front over a map; arguments as of `coverage`."""
        return self.post(coverage_plan(request, png))

    def plan(self, plan: Plan) -> Front:
        """Send a plan that was built before, and wait for the front."""
        return self._connection.run(self._calls.plan(plan, parse_front))

    def plan_fleet(self, plan: Plan) -> FleetFront:
        """Send a plan for a fleet that was built before, and wait for the front of its plans."""
        return self._connection.run(self._calls.plan(plan, parse_fleet))

    def plan_robots(self, plan: Plan) -> RobotFront:
        """Send a plan for robots that was built before, and wait for the front of its plans."""
        return self._connection.run(self._calls.plan(plan, parse_robots))

    def post(self, plan: Plan) -> "Job[Front]":
        """Send a plan that was built before, as a job."""
        return self.job(self._connection.run(self._calls.submit(plan)))

    def job(self, front: str) -> "Job[Front]":
        """Return the job of a front by its id, without asking whether the service knows it."""
        return Job(front, parse_front, self._connection, self._calls)

    def fleet_job(self, front: str) -> "Job[FleetFront]":
        """Return the job of a front of plans, in the same way."""
        return Job(front, parse_fleet, self._connection, self._calls)

    def robots_job(self, front: str) -> "Job[RobotFront]":
        """Return the job of a front of plans for several robots, in the same way."""
        return Job(front, parse_robots, self._connection, self._calls)

    def any_job(self, front: str) -> "Job[FrontOfAnyKind]":
        """Return the job of a front of whatever kind, in the same way."""
        return Job(front, parse_any, self._connection, self._calls)

    def tour(
        self, angle: float | None = None, front: str | None = None, **choice: Unpack[Choice]
    ) -> Tour:
        """Return a tour of a front by its id, or of the latest, as `Front.choose` does."""
        return self._connection.run(self._calls.tour(angle, front, choice))

    def geojson(
        self, front: str, geometry: Geometry = "straight", plan: int | None = None
    ) -> dict[str, Any]:
        """Return a front by its id as a FeatureCollection (RFC 7946), if its stops have locations.

        Args:
            front: The front's id.
            geometry: Whether its lines are straight, or follow the streets, which needs a routing
                engine in the service.
            plan: For a fleet, the index of the one plan to draw, from 0; None draws all.
        """
        return self._connection.run(self._calls.geojson(front, geometry, plan))

    def actors(self) -> tuple[Actor, ...]:
        """Return the actors that the service has loaded."""
        return self._connection.run(self._calls.actors())

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
