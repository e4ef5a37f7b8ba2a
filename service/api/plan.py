"""The paths that plan fronts: `POST /front` and `POST /coverage`."""

import asyncio
import hashlib
import uuid
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import Response

from service.actor import ActorInfo
from service.api.body import Reader, read_body
from service.api.request_headers import PARAMETERS, idempotency_key, wants_it_later
from service.api.responses import (
    AcceptedAnswer,
    CoverageAnswer,
    FrontAnswer,
    json_bytes,
    json_response,
    problem_bytes,
    problem_responses,
)
from service.jobs.engine import Engine, final_record
from service.jobs.front_document import FrontDocument, empty_front
from service.jobs.record import Record
from service.jobs.store import Store
from service.requests.coverage import coverage_schema
from service.requests.front import request_schema
from service.requests.limits import Limits
from service.requests.task import TaskKind, TaskSource


def caller_of(request: Request) -> str:
    """Who asks; all that shows no key is one caller."""
    return str(request.scope["caller"])


class Answers:
    """Hands work to the engine, and fronts to those who asked."""

    def __init__(self, engine: Engine, store: Store) -> None:
        self._engine = engine
        self._store = store

    async def check_place(self, request: Request) -> None:
        """Nothing, if more work is taken. A repeat may need no place.

        Raises:
            QueueFull: the queue is full.
            ShuttingDown: no more work is taken.
        """
        await self._engine.check_open()
        if idempotency_key(request) is None:
            await self._engine.check_place()

    async def answer(self, request: Request, source: TaskSource, empty: FrontDocument) -> Response:
        """The front, or where it will be found.

        Work without an idempotency key ends when the client goes away. With one the client is
        expected to come back, so that the work goes on.
        """
        key = idempotency_key(request)
        record = Record(
            id=uuid.uuid4().hex,
            caller=caller_of(request),
            request_id=request.scope["request_id"],
            status="queued",
            front=empty,
            source=source,
            key=key,
            digest=await asyncio.to_thread(_digest, source) if key else "",
        )
        if wants_it_later(request):
            return _accepted(self._engine.state(await self._begun(record)).record)
        if record.key is not None:
            return _finished(request, await final_record(self._engine, await self._begun(record)))
        return _finished(request, await self._now(request, record))

    async def _now(self, request: Request, record: Record) -> Record:
        leaving = asyncio.ensure_future(_left(request))
        try:
            return await self._engine.run(record, leaving)
        finally:
            leaving.cancel()

    async def _begun(self, record: Record) -> Record:
        """The record, or the earlier one of which it is a repeat."""
        kept = await self._store.admit(record)
        if kept.id == record.id:
            try:
                await self._engine.submit(record)
            except Exception:
                await self._store.delete(record)
                raise
        return kept


async def _left(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass


def _accepted(record: Record) -> Response:
    answer = json_response({"id": record.id, "status": record.status}, 202)
    answer.headers["Location"] = f"/front/{record.id}"
    answer.headers["Preference-Applied"] = "respond-async"
    return answer


def _finished(request: Request, record: Record) -> Response:
    if record.problem is None:
        return json_bytes(record.json())
    # Which may be the problem of a request that this one repeats.
    return problem_bytes({**record.problem, "request_id": request.scope["request_id"]})


def _digest(source: TaskSource) -> str:
    digest = hashlib.sha256()
    for part in (source.kind.encode(), source.body, source.upload or b""):
        digest.update(b"%d:" % len(part))
        digest.update(part)
    return digest.hexdigest()


_UPLOADS: Mapping[TaskKind, str] = {"front": "matrices", "coverage": "map"}
_EXAMPLE = {"id": "07787526fece4cbebaab8053b07b26f3", "status": "queued"}
_ACCEPTED = {"application/json": {"example": _EXAMPLE}}


class FrontRoutes:
    """Checks what is asked for, and has it planned."""

    def __init__(
        self,
        actors: Mapping[str, ActorInfo],
        engine: Engine,
        answers: Answers,
        limits: Limits,
    ) -> None:
        self._actors = actors
        self._engine = engine
        self._answers = answers
        self._limits = limits
        self._reader = Reader(limits, actors)

    def router(self) -> APIRouter:
        """The paths, with what the OpenAPI document says of them."""
        router = APIRouter(tags=["fronts"])
        said: dict[int | str, dict[str, Any]] = {
            202: {"model": AcceptedAnswer, "description": "Accepted", "content": _ACCEPTED},
            **problem_responses(400, 408, 413, 415, 422, 503, 504),
        }
        router.post(
            "/front",
            response_model=FrontAnswer,
            responses=said,
            openapi_extra=_asked(request_schema(self._limits, self._actors)),
        )(self.plan_front)
        router.post(
            "/coverage",
            response_model=CoverageAnswer,
            responses=said,
            openapi_extra=_asked(coverage_schema(self._limits, self._actors)),
        )(self.plan_coverage)
        return router

    async def plan_front(self, request: Request) -> Response:
        """Plan the front of tours through the cities given.

        Matrices may come as a .npy file of shape (2, n, n) instead: the part `matrices` of a
        multipart/form-data body, beside the part `request` with everything else.

        With `Prefer: respond-async` the answer is 202 at once, and `Location` says where the front
        will be. A repeat with the same `Idempotency-Key` is answered with the front of the first.
        """
        return await self._plan(request, "front")

    async def plan_coverage(self, request: Request) -> Response:
        """Plan the front of tours through places on a map, and on request their paths.

        The map may come as a PNG file instead, where dark is an obstacle: the part `map` of a
        multipart/form-data body, beside the part `request` with everything else.

        With `Prefer: respond-async` the answer is 202 at once, and `Location` says where the front
        will be. A repeat with the same `Idempotency-Key` is answered with the front of the first.
        """
        return await self._plan(request, "coverage")

    async def _plan(self, request: Request, kind: TaskKind) -> Response:
        await self._answers.check_place(request)
        body = await read_body(request, self._limits.body_bytes, _UPLOADS[kind])
        source = TaskSource(kind, body.json, body.upload)
        task = await self._reader.read(source)
        if task.needs_compiled_code:
            await self._engine.check_warm()
        empty = empty_front(task, self._actors[task.actor].identity)
        return await self._answers.answer(request, replace(source, task=task), empty)


def _asked(schema: dict[str, Any]) -> dict[str, Any]:
    content = {"application/json": {"schema": schema}}
    return {
        "parameters": list(PARAMETERS),
        "requestBody": {"required": True, "content": content},
    }
