"""The paths that tell of fronts, planned or being planned, and forget them."""

from typing import Annotated, Any, NoReturn

from fastapi import APIRouter, Query
from pydantic_core import to_json
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse

from service.api.answers import caller_of
from service.api.body import json_bytes
from service.api.events import event_stream
from service.api.responses import FrontAnswer, TourAnswer
from service.errors import Refusal, responses
from service.jobs.engine import Engine
from service.jobs.record import Record
from service.jobs.store import Expired, Store, Unknown
from service.requests.schemas import TourQuery


class KeptRoutes:
    """Each caller is told of its own fronts alone."""

    def __init__(self, store: Store, engine: Engine) -> None:
        self._store = store
        self._engine = engine

    def router(self) -> APIRouter:
        """The paths, with what the OpenAPI document says of them."""
        router = APIRouter(tags=["fronts"])
        missing = responses(404, 410, 503)
        stream: dict[str, Any] = {"description": "The events", "content": {"text/event-stream": {}}}
        router.get("/front/{id}", response_model=FrontAnswer, responses=missing)(self.front)
        router.delete(
            "/front/{id}",
            response_model=FrontAnswer,
            responses={204: {"description": "Forgotten"}, **missing},
        )(self.forget)
        router.get(
            "/front/{id}/events",
            response_class=StreamingResponse,
            responses={200: stream, **missing},
        )(self.events)
        router.get("/tour", response_model=TourAnswer, responses=responses(404, 410, 422, 503))(
            self.tour
        )
        return router

    async def front(self, request: Request, id: str) -> Response:  # noqa: A002
        """Give a front again, or the best so far of one that is being planned."""
        return json_bytes((await self._record(request, id)).json())

    async def forget(self, request: Request, id: str) -> Response:  # noqa: A002
        """Forget a front; one that is being planned ends with what was found, and is kept."""
        record = await self._record(request, id)
        if record.finished:
            await self._store.forget(record)
            return Response(status_code=204)
        return json_bytes((await self._engine.cancel(record)).json())

    async def events(self, request: Request, id: str) -> Response:  # noqa: A002
        """Tell how the planning of a front goes, until it has ended."""
        return event_stream(self._engine.states(await self._record(request, id)))

    async def tour(self, request: Request, query: Annotated[TourQuery, Query()]) -> Response:
        """Give the tour of a front whose direction is nearest to an angle."""
        record = await self._record(request, query.front)
        if not record.front.tours:
            sentence = f"front {record.id} must have a tour, and has none yet"
            raise Refusal(404, "no-tour", sentence)
        tour = record.front.nearest(query.angle)
        return json_bytes(b'{"front":' + to_json(record.id) + b"," + tour[1:])

    async def _record(self, request: Request, front: str | None) -> Record:
        caller, store = caller_of(request), self._store
        try:
            kept = store.latest(caller) if front is None else store.get(caller, front)
            return self._engine.state(await kept).record
        except Unknown:
            _refuse_unknown(front)
        except Expired:
            sentence = f"front {_named(front)} was kept for a while and is no more: plan it again"
            raise Refusal(410, "front-expired", sentence) from None


def _refuse_unknown(front: str | None) -> NoReturn:
    if front is None:
        raise Refusal(404, "no-front", "a tour is of a front: plan one with POST /front first")
    raise Refusal(404, "unknown-front", f"there is no front {_named(front)}")


def _named(front: str | None) -> str:
    return "the latest" if front is None else repr(front[:80])
