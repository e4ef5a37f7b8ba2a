"""The routes that plan: `POST /front`, `/coverage`, `/fleet` and `/front/{id}/replan`."""

import asyncio
import hashlib
import uuid
from dataclasses import dataclass, field
from typing import Any

from fastapi import APIRouter
from paretour.plans import FleetFront, RobotFront
from paretour.values import Front
from starlette.requests import Request
from starlette.responses import Response

from service.api.answers import CoverageAnswer
from service.api.auth import caller_of, client_of
from service.api.body import receive_source
from service.api.body_budget import BodyAllowance, BodyBudget
from service.api.disconnect import disconnected
from service.api.geojson.answers import FRONT_CONTENT, TEXT_CONTENT, FrontAnswers
from service.api.middleware import ANSWER_HEADERS
from service.api.request_bodies import COVERAGE_BODY, FLEET_BODY, FRONT_BODY, REPLAN_BODY
from service.api.request_headers import PARAMETERS, idempotency_key, prefers_async, webhook_url
from service.api.response_headers import REPLAYED
from service.api.responses import (
    AcceptedAnswer,
    json_response,
    problem_bytes,
    problem_responses,
    problem_under,
    root_path_of,
)
from service.api.schemas import documented
from service.api.stored_fronts import find_stored
from service.api.task_parser import TaskParser
from service.jobs.deadline import Deadline
from service.jobs.engine import Engine, record_in_time
from service.jobs.record import Record
from service.jobs.store import Store
from service.jobs.webhook import Webhook
from service.kinds.table import empty_document
from service.requests.fields import Geometry
from service.requests.task import Task, TaskKind, TaskSource
from service.requests.task_codec import encode_task
from service.webhooks.targets import Targets

_LONG = 2**20  # bytes of a body; the task of a longer one takes a while to write
_EXAMPLE = {"id": "07787526fece4cbebaab8053b07b26f3", "status": "queued"}
_ACCEPTED = {"application/json": {"example": _EXAMPLE}}


@dataclass(frozen=True, eq=False)
class PlanRoutes:
    """Parses a request for a front, has the engine plan it, and answers at once or when it is done.

    A request without an idempotency key ends when its client goes away. With a key the client is
    expected to come back, so planning continues, even after the `seconds` of the request are over
    and it was answered with the best front so far.
    """

    parser: TaskParser
    budget: BodyBudget
    most_bytes: int
    engine: Engine
    store: Store
    seconds: float
    answers: FrontAnswers
    targets: Targets
    held: set[asyncio.Task[None]] = field(default_factory=set)  # until bodies are released

    def router(self) -> APIRouter:
        """Return the routes with their entries in the OpenAPI document."""
        router = APIRouter(tags=["fronts"])
        responses: dict[int | str, dict[str, Any]] = {
            200: TEXT_CONTENT,
            202: {"model": AcceptedAnswer, "description": "Accepted", "content": _ACCEPTED},
            **problem_responses(400, 406, 408, 413, 415, 422, 503, 504),
        }
        with_roads = {200: FRONT_CONTENT, **problem_responses(502)}
        of_earlier = {**with_roads, **problem_responses(404, 409, 410)}
        of_map, rest = CoverageAnswer | RobotFront, Front | CoverageAnswer | FleetFront
        for path, endpoint, answer, body, more in (
            ("/front", self.plan_front, Front, FRONT_BODY, with_roads),
            ("/coverage", self.plan_coverage, of_map, COVERAGE_BODY, {}),
            ("/front/{id}/replan", self.replan_front, rest, REPLAN_BODY, of_earlier),
            ("/fleet", self.plan_fleet, FleetFront, FLEET_BODY, with_roads),
        ):
            router.post(
                path,
                response_model=documented(answer),
                responses={**responses, **more},
                openapi_extra={"parameters": list(PARAMETERS), "requestBody": body},
            )(endpoint)
        return router

    async def plan_front(self, request: Request) -> Response:
        """Plan the front of tours through the cities given.

        Matrices may come as a .npy file of shape (2, n, n) instead: the part `matrices` of a
        multipart/form-data body, beside the part `request` with everything else.

        With `Accept: application/geo+json`, and stops that have locations, the answer is GeoJSON.
        Its lines follow the streets where `geometry` says `roads`. With `Accept: text/plain` it is
        the lengths alone, as a set of points that `moocore` reads.

        With `Prefer: respond-async` the answer is 202 at once, and `Location` says where the front
        will be. A repeat with the same `Idempotency-Key` is answered with the front of the first.
        """
        return await self._plan(request, "front")

    async def plan_coverage(self, request: Request) -> Response:
        """Plan the front of tours through places on a map, or of plans for several robots.

        The map may come as a PNG or PGM file instead, where dark is an obstacle: the part `map` of
        a multipart/form-data body, beside the part `request` with everything else.

        With `Prefer: respond-async` the answer is 202 at once, and `Location` says where the front
        will be. A repeat with the same `Idempotency-Key` is answered with the front of the first.
        """
        return await self._plan(request, "coverage")

    async def plan_fleet(self, request: Request) -> Response:
        """Plan the front of plans for several vehicles. A plan has a route for each vehicle used.

        With `Accept: application/geo+json`, and stops that have locations, the answer is GeoJSON.

        With `Prefer: respond-async` the answer is 202 at once, and `Location` says where the front
        will be. A repeat with the same `Idempotency-Key` is answered with the front of the first.
        """
        return await self._plan(request, "fleet")

    async def replan_front(self, request: Request, id: str) -> Response:
        """Plan the rest of a tour or of a fleet's plan that is driven, after something has changed.

        Stops were done, added or removed, the vehicle is elsewhere, or costs or the map changed.
        The answer is a front of open routes from the position through the remaining stops to the
        old end; for a closed tour, back to its start. Each tour has `kept`, the share of the
        driven tour's remaining legs that it keeps. The earlier front stays as it is.

        Of a fleet, the answer is a front of plans from now on: vehicles on their way go on from
        where they are with what they carry, others have not left.

        Headers work as in `POST /front`. The answer is a new front, which can be replanned too.
        """
        return await self._plan(request, "replan", id)

    async def _plan(self, request: Request, kind: TaskKind, front: str | None = None) -> Response:
        await self._check_place(request)
        webhook_url(request, self.targets)  # it may be refused before the body is received
        # Counted until there is an answer: a task that waits or is being planned holds its body.
        with self.budget.open(client_of(request)) as allowance:
            received = await receive_source(request, kind, self.most_bytes, allowance)
            deadline = Deadline.after(self.seconds)
            if front is None:
                task = await self.parser.parse(received, client_of(request))
            else:
                task = await self._rest(request, received, front)
            record = await self._new_record(request, task, received, front)
            return await self._planned(request, record, task, allowance, deadline)

    async def _rest(self, request: Request, body: TaskSource, front: str) -> Task:
        """Return the rest of the way of a stored front.

        Raises:
            Refusal: The front does not exist, or cannot be replanned as the body asks.
        """
        self.parser.check_replan(body.body)
        asked, length = await find_stored(self.store, request, front, body)
        return await self.parser.replan(asked, length, client_of(request))

    async def _planned(
        self,
        request: Request,
        record: Record,
        task: Task,
        allowance: BodyAllowance,
        deadline: Deadline,
    ) -> Response:
        """Have the engine plan a task, and answer as the request's headers ask for."""
        geometry = task.geometry
        self.answers.check(request, record.front.stops, geometry)
        if prefers_async(request):
            first = await self._submit(request, record, task, allowance)
            return _accepted_response(request, self.engine.state(first).record, geometry)
        if record.key is None:
            record = await self._run(request, record, task, deadline)
        else:
            first = await self._submit(request, record, task, allowance)
            record = await record_in_time(self.engine, first, deadline)
        if record.problem is None:
            return await self.answers.front(request, record, geometry, deadline.left())
        # The problem may be that of an earlier request that this one repeats.
        scope = request.scope
        document = problem_under(root_path_of(scope), record.problem)
        return problem_bytes({**document, "request_id": scope["request_id"]})

    async def _submit(
        self, request: Request, record: Record, task: Task, allowance: BodyAllowance
    ) -> Record:
        """Submit a job. Its body counts against the budget until the engine releases it."""
        first = await self.engine.submit(record, task)
        if first.id != record.id:
            request.scope[ANSWER_HEADERS].append(REPLAYED)
        else:
            holding = asyncio.create_task(self._hold(record, allowance.hand_over()))
            self.held.add(holding)
            holding.add_done_callback(self.held.discard)
        return first

    async def _hold(self, record: Record, allowance: BodyAllowance) -> None:
        with allowance:
            await self.engine.release(record)

    async def _check_place(self, request: Request) -> None:
        """Raise a refusal, before the body is received, if the engine takes no more tasks."""
        await self.engine.check_open()
        # A repeat may need no place.
        if idempotency_key(request) is None:
            await self.engine.check_place(client_of(request))

    async def _new_record(
        self, request: Request, task: Task, body: TaskSource, front: str | None
    ) -> Record:
        key = idempotency_key(request)
        url = webhook_url(request, self.targets)
        long = body.length > _LONG
        id_ = uuid.uuid4().hex
        return Record(
            id=id_,
            caller=caller_of(request),
            request_id=request.scope["request_id"],
            status="queued",
            front=empty_document(task),
            task=await asyncio.to_thread(encode_task, task) if long else encode_task(task),
            key=key,
            digest=await asyncio.to_thread(_digest, body, front) if key else "",
            client=client_of(request),
            webhook=Webhook(url, _location(request, id_, task.geometry)) if url else None,
        )

    async def _run(
        self, request: Request, record: Record, task: Task, deadline: Deadline
    ) -> Record:
        disconnect = asyncio.ensure_future(disconnected(request))
        try:
            return await self.engine.run(record, task, disconnect, deadline)
        finally:
            disconnect.cancel()


def _accepted_response(request: Request, record: Record, geometry: Geometry) -> Response:
    response = json_response({"id": record.id, "status": record.status}, 202)
    response.headers["Location"] = _location(request, record.id, geometry)
    response.headers["Preference-Applied"] = "respond-async"
    return response


def _location(request: Request, id: str, geometry: Geometry) -> str:
    query = "" if geometry == "straight" else f"?geometry={geometry}"
    return f"{root_path_of(request.scope)}/front/{id}{query}"


def _digest(body: TaskSource, front: str | None) -> str:
    """Return the SHA-256 of a body, by which a reused idempotency key is recognised."""
    digest = hashlib.sha256()
    parts = [body.kind.encode(), body.body, body.upload or b""]
    parts += [] if front is None else [front.encode()]
    for part in parts:
        digest.update(b"%d:" % len(part))
        digest.update(part)
    return digest.hexdigest()
