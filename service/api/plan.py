"""The paths that plan fronts."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import Response

from service.actor import ActorFacts
from service.api.answers import Answers
from service.api.body import read_body
from service.api.reading import Reader
from service.api.request_headers import PARAMETERS
from service.api.responses import AcceptedAnswer, CoverageAnswer, FrontAnswer
from service.errors import responses
from service.jobs.engine import Engine
from service.jobs.messages import Work, WorkKind
from service.requests.asked import nothing_yet
from service.requests.coverage import coverage_schema
from service.requests.front import request_schema
from service.requests.schemas import Limits

_UPLOADS: Mapping[WorkKind, str] = {"front": "matrices", "coverage": "map"}
_EXAMPLE = {"id": "07787526fece4cbebaab8053b07b26f3", "status": "queued"}
_ACCEPTED = {"application/json": {"example": _EXAMPLE}}


class FrontRoutes:
    """Checks what is asked for, and has it planned."""

    def __init__(
        self,
        actors: Mapping[str, ActorFacts],
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
            **responses(400, 408, 413, 415, 422, 503, 504),
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

    async def _plan(self, request: Request, kind: WorkKind) -> Response:
        await self._answers.check_place(request)
        body = await read_body(request, self._limits.body_bytes, _UPLOADS[kind])
        work = Work(kind, body.json, body.upload)
        task = await self._reader.read(work)
        if task.needs_compiled_code:
            await self._engine.check_warm()
        nothing = nothing_yet(task, self._actors[task.actor].named)
        return await self._answers.answer(request, replace(work, task=task), nothing)


def _asked(schema: dict[str, Any]) -> dict[str, Any]:
    content = {"application/json": {"schema": schema}}
    return {
        "parameters": list(PARAMETERS),
        "requestBody": {"required": True, "content": content},
    }
