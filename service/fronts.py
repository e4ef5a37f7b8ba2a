"""The paths that plan fronts and answer questions about them."""

import asyncio
import uuid
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, NoReturn

from fastapi import APIRouter, Query
from pydantic_core import to_json
from starlette.requests import Request
from starlette.responses import Response

from service.actor import ActorFacts
from service.bodies import json_body, json_bytes
from service.messages import Work
from service.order import Order
from service.problems import Refusal, responses
from service.rendered import Rendered
from service.requests import parse_front_request, request_schema
from service.roster import choose_actor
from service.schemas import FrontAnswer, Limits, TourAnswer, TourQuery
from service.store import Expired, Store, Unknown
from service.workers import Workers


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
        schema = request_schema(self._limits, self._actors)
        body = {"required": True, "content": {"application/json": {"schema": schema}}}
        router.post(
            "/front",
            response_model=FrontAnswer,
            responses=responses(400, 408, 413, 415, 422, 503, 504),
            openapi_extra={"requestBody": body},
        )(self.plan_front)
        router.get("/front/{id}", response_model=FrontAnswer, responses=responses(404, 410))(
            self.front
        )
        router.get("/tour", response_model=TourAnswer, responses=responses(404, 410, 422))(
            self.tour
        )
        return router

    async def plan_front(self, request: Request) -> Response:
        """Plan the front of tours through the cities given."""
        _check_prefer(request)
        self._workers.check_open()
        self._workers.check_place()
        body = await json_body(request, self._limits.body_bytes)
        order = self._workers.order(self._work(body))
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

    def _work(self, body: bytes) -> Work:
        asked = parse_front_request(body, self._limits)
        choose_actor(self._actors, asked.kind, asked.named_actor)
        asked.instance()  # which raises where there is none
        if asked.demand().needs_compiled_code:
            self._workers.check_warm()
        return Work("front", body)

    def _kept(self, front: str | None) -> KeptFront:
        try:
            return self._store.latest() if front is None else self._store.get(front)
        except Unknown:
            _refuse_unknown(front)
        except Expired:
            sentence = f"front {_named(front)} was kept for a while and is no more: plan it again"
            raise Refusal(410, "front-expired", sentence) from None


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
