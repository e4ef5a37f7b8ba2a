"""The paths that plan fronts and answer questions about them."""

import asyncio
import uuid
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, NoReturn

from fastapi import APIRouter, Query
from pydantic_core import to_json
from starlette.requests import Request
from starlette.responses import Response

from service.actor import ActorFacts
from service.asked import parse
from service.bodies import json_bytes, read_body
from service.covering import CoverageRequest, coverage_schema
from service.messages import Work, WorkKind
from service.order import Order
from service.problems import Refusal, responses
from service.rendered import Rendered
from service.requests import request_schema
from service.roster import choose_actor
from service.schemas import CoverageAnswer, FrontAnswer, Limits, TourAnswer, TourQuery
from service.store import Expired, Store, Unknown
from service.workers import Workers

_UPLOADS: Mapping[WorkKind, str] = {"front": "matrices", "coverage": "map"}


@dataclass(frozen=True, eq=False)
class KeptFront:
    """A front as it was answered, for when it is asked for again."""

    id: str
    front: Rendered

    def answer(self) -> Response:
        """A FrontAnswer."""
        return json_bytes(self.front.json(id=self.id, status="done"))

    def nearest(self, angle: float) -> Response:
        """A TourAnswer."""
        tour = self.front.nearest(angle)
        return json_bytes(b'{"front":' + to_json(self.id) + b"," + tour[1:])


class FrontRoutes:
    """Plans fronts on the workers and keeps them in the store."""

    def __init__(
        self,
        actors: Mapping[str, ActorFacts],
        store: Store[KeptFront],
        workers: Workers,
        limits: Limits,
    ) -> None:
        self._actors = actors
        self._store = store
        self._workers = workers
        self._limits = limits

    def router(self) -> APIRouter:
        """The paths, with what the OpenAPI document says of them."""
        router = APIRouter(tags=["fronts"])
        refusals = responses(400, 408, 413, 415, 422, 503, 504)
        router.post(
            "/front",
            response_model=FrontAnswer,
            responses=refusals,
            openapi_extra=_body(request_schema(self._limits, self._actors)),
        )(self.plan_front)
        router.post(
            "/coverage",
            response_model=CoverageAnswer,
            responses=refusals,
            openapi_extra=_body(coverage_schema(self._limits, self._actors)),
        )(self.plan_coverage)
        router.get("/front/{id}", response_model=FrontAnswer, responses=responses(404, 410))(
            self.front
        )
        router.get("/tour", response_model=TourAnswer, responses=responses(404, 410, 422))(
            self.tour
        )
        return router

    async def plan_front(self, request: Request) -> Response:
        """Plan the front of tours through the cities given.

        Matrices may come as a .npy file of shape (2, n, n) instead: the part `matrices` of a
        multipart/form-data body, beside the part `request` with everything else.
        """
        return await self._plan(request, "front")

    async def plan_coverage(self, request: Request) -> Response:
        """Plan the front of tours through places on a map, and on request their paths.

        The map may come as a PNG file instead, where dark is an obstacle: the part `map` of a
        multipart/form-data body, beside the part `request` with everything else.
        """
        return await self._plan(request, "coverage")

    async def _plan(self, request: Request, kind: WorkKind) -> Response:
        _check_prefer(request)
        self._workers.check_open()
        self._workers.check_place()
        body = await read_body(request, self._limits.body_bytes, _UPLOADS[kind])
        work = Work(kind, body.json, body.upload)
        self._check(work)
        order = self._workers.order(work)
        await _while_wanted(request, order, self._workers)
        kept = KeptFront(uuid.uuid4().hex, await order.front())
        self._store.put(kept.id, kept)
        return kept.answer()

    async def front(self, id: str) -> Response:  # noqa: A002
        """Give a front again."""
        return self._kept(id).answer()

    async def tour(self, query: Annotated[TourQuery, Query()]) -> Response:
        """Give the tour of a front whose direction is nearest to an angle."""
        return self._kept(query.front).nearest(query.angle)

    def _check(self, work: Work) -> None:
        asked = parse(work, self._limits)
        choose_actor(self._actors, asked.kind, asked.named_actor)
        # Either raises where there is none.
        if isinstance(asked, CoverageRequest):
            asked.coverage()
        else:
            asked.instance()
        if isinstance(asked, CoverageRequest) or asked.demand().needs_compiled_code:
            self._workers.check_warm()

    def _kept(self, front: str | None) -> KeptFront:
        try:
            return self._store.latest() if front is None else self._store.get(front)
        except Unknown:
            _refuse_unknown(front)
        except Expired:
            sentence = f"front {_named(front)} was kept for a while and is no more: plan it again"
            raise Refusal(410, "front-expired", sentence) from None


def _body(schema: dict[str, Any]) -> dict[str, Any]:
    content = {"application/json": {"schema": schema}}
    return {"requestBody": {"required": True, "content": content}}


async def _while_wanted(request: Request, order: Order, workers: Workers) -> None:
    """Wait for the order's end, and stop it as soon as the client has gone away."""
    working = asyncio.ensure_future(order.front())
    leaving = asyncio.ensure_future(_left(request))
    try:
        await asyncio.wait((working, leaving), return_when=asyncio.FIRST_COMPLETED)
    finally:
        workers.stop(order)
        working.cancel()
        leaving.cancel()


async def _left(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass


def _check_prefer(request: Request) -> None:
    preferences = ",".join(request.headers.getlist("prefer")).lower().split(",")
    if "respond-async" in (each.partition(";")[0].strip() for each in preferences):
        sentence = "there are no asynchronous answers yet: leave out Prefer: respond-async"
        raise Refusal(422, "not-available", sentence)


def _refuse_unknown(front: str | None) -> NoReturn:
    if front is None:
        raise Refusal(404, "no-front", "a tour is of a front: plan one with POST /front first")
    raise Refusal(404, "unknown-front", f"there is no front {_named(front)}")


def _named(front: str | None) -> str:
    return "the latest" if front is None else repr(front[:80])
