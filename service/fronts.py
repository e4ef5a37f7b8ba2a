"""The paths that plan fronts and answer questions about them."""

import asyncio
import time
import uuid
from collections.abc import Coroutine, Mapping
from dataclasses import dataclass, replace
from functools import partial
from threading import Event
from typing import Annotated, Any, NoReturn, Protocol, TypeVar

import numpy as np
from fastapi import APIRouter, Query
from starlette.requests import Request
from starlette.responses import Response

from service.actor import ActorFacts
from service.bodies import json_body, json_response
from service.planner import Constructor, Front, plan
from service.problems import Refusal, responses
from service.requests import parse_front_request, request_schema
from service.roster import choose_actor
from service.schemas import (
    FrontAnswer,
    FrontRequest,
    Limits,
    TourAnswer,
    TourQuery,
)
from service.store import Expired, Store, Unknown
from service.workers import Workers

T = TypeVar("T")
_GLANCE = 0.1  # seconds between two looks at whether the client is still there


class NamedActor(Constructor, Protocol):
    """A constructor that says who it is."""

    @property
    def facts(self) -> ActorFacts:
        """Who it is."""


@dataclass(frozen=True, eq=False)
class KeptFront:
    """A front as it was answered, for when it is asked for again."""

    id: str
    front: Front
    actor: ActorFacts

    def answer(self) -> dict[str, Any]:
        """The members of a FrontAnswer."""
        front = self.front
        return {
            "id": self.id,
            "cities": front.n,
            "front": [self._item(index) for index in range(len(front.points))],
            "points": front.found,
            "hypervolume": front.hypervolume,
            "hypervolume_bound": front.bound,
            "reference_point": front.reference_point.tolist(),
            "scale": front.scale.tolist(),
            "actor": {"name": self.actor.name, "digest": self.actor.digest},
            "timings_ms": front.timings,
            "terminated": front.terminated,
        }

    def nearest(self, angle: float) -> dict[str, Any]:
        """The members of a TourAnswer."""
        return {"front": self.id, **self._item(self.front.nearest(angle))}

    def _item(self, index: int) -> dict[str, Any]:
        front = self.front
        return {
            "angle": float(front.angles[index]),
            "lengths": front.points[index].tolist(),
            "tour": front.tours[index].tolist(),
        }


class FrontRoutes:
    """Plans fronts on the workers and keeps them in the store."""

    def __init__(
        self,
        actors: Mapping[str, NamedActor],
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
            responses=responses(400, 408, 413, 415, 422, 503),
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
        body = await json_body(request, self._limits.body_bytes)
        asked = parse_front_request(body, self._limits)
        loaded = {name: actor.facts for name, actor in self._actors.items()}
        actor = self._actors[choose_actor(loaded, asked.kind, asked.named_actor)]
        front = await self._plan(request, actor, asked)
        kept = KeptFront(uuid.uuid4().hex, front, actor.facts)
        if front.terminated != "cancelled":
            self._store.put(kept.id, kept)
        return json_response(kept.answer())

    async def front(self, id: str) -> Response:  # noqa: A002
        """Give a front again."""
        return json_response(self._kept(id).answer())

    async def tour(self, query: Annotated[TourQuery, Query()]) -> Response:
        """Give the tour of a front whose direction is nearest to an angle."""
        return json_response(self._kept(query.front).nearest(query.angle))

    async def _plan(self, request: Request, actor: NamedActor, asked: FrontRequest) -> Front:
        demand = asked.demand()
        if demand.needs_compiled_code:
            self._workers.check_warm()
        asked_at = time.perf_counter()
        stop = Event()
        work = partial(plan, actor, asked.instance(), demand, stop.is_set)
        front = await _while_wanted(request, self._workers.run(work), stop)
        total = 1000 * (time.perf_counter() - asked_at)
        waited = total - sum(front.timings.values())
        # Kept fronts are what fills the memory: no city number needs eight bytes.
        return replace(
            front,
            tours=front.tours.astype(np.uint32),
            timings={"queue": waited, **front.timings, "total": total},
        )

    def _kept(self, front: str | None) -> KeptFront:
        try:
            return self._store.latest() if front is None else self._store.get(front)
        except Unknown:
            _refuse_unknown(front)
        except Expired:
            sentence = f"front {_named(front)} was kept for a while and is no more: plan it again"
            raise Refusal(410, "front-expired", sentence) from None


async def _while_wanted(request: Request, work: Coroutine[Any, Any, T], stop: Event) -> T:
    """What the work returns; it is told to stop as soon as the client has gone away."""
    working = asyncio.ensure_future(work)
    leaving = asyncio.ensure_future(_left(request))
    try:
        await asyncio.wait((working, leaving), return_when=asyncio.FIRST_COMPLETED)
        stop.set()
        return await working
    finally:
        stop.set()
        leaving.cancel()


async def _left(request: Request) -> None:
    while not await request.is_disconnected():
        await asyncio.sleep(_GLANCE)


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
