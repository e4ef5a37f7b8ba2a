"""The paths that read, follow, cancel and forget fronts that are kept."""

import asyncio
from collections.abc import AsyncIterator, Mapping
from dataclasses import asdict
from typing import Annotated, Any, NoReturn

from fastapi import APIRouter, Query
from fastapi.sse import KEEPALIVE_COMMENT, format_sse_event
from pydantic_core import to_json
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse

from service.api.plan import caller_of
from service.api.responses import FrontAnswer, TourAnswer, json_bytes, problem_responses
from service.errors import Expired, NotFound, Refusal
from service.jobs.engine import Engine, JobState
from service.jobs.record import Record
from service.jobs.store import Store
from service.requests.schemas import TourQuery
from service.search.improve import Progress

HEARTBEAT = 15.0  # seconds of silence before a comment says that the stream is alive


def event_stream(watch: AsyncIterator[JobState]) -> StreamingResponse:
    """An answer that goes on until the job is finished."""
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return StreamingResponse(_events(watch), media_type="text/event-stream", headers=headers)


async def _events(watch: AsyncIterator[JobState]) -> AsyncIterator[bytes]:
    status, progress = None, None
    async for state in _with_heartbeats(watch):
        if state is None:
            yield KEEPALIVE_COMMENT
            continue
        # Before the status that ends the stream, whatever is left to say.
        if state.progress is not None and state.progress is not progress:
            progress = state.progress
            yield _progress(progress)
        if state.record.status != status:
            status = state.record.status
            yield _status(state.record)


async def _with_heartbeats(watch: AsyncIterator[JobState]) -> AsyncIterator[JobState | None]:
    """The states, and none for each while without."""
    coming = asyncio.ensure_future(anext(watch, None))
    try:
        while True:
            done, _ = await asyncio.wait([coming], timeout=HEARTBEAT)
            if not done:
                yield None
                continue
            state = coming.result()
            if state is None:
                return
            coming = asyncio.ensure_future(anext(watch, None))
            yield state
    finally:
        coming.cancel()


def _status(record: Record) -> bytes:
    return _event("status", {"id": record.id, "status": record.status})


def _progress(progress: Progress) -> bytes:
    return _event("progress", asdict(progress))


def _event(name: str, data: Mapping[str, object]) -> bytes:
    return format_sse_event(event=name, data_str=to_json(data).decode())


class StoredFrontRoutes:
    """Each caller is told of its own fronts alone."""

    def __init__(self, store: Store, engine: Engine) -> None:
        self._store = store
        self._engine = engine

    def router(self) -> APIRouter:
        """The paths, with what the OpenAPI document says of them."""
        router = APIRouter(tags=["fronts"])
        missing = problem_responses(404, 410, 503)
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
        router.get(
            "/tour", response_model=TourAnswer, responses=problem_responses(404, 410, 422, 503)
        )(self.tour)
        return router

    async def front(self, request: Request, id: str) -> Response:  # noqa: A002
        """Give a front again, or the best so far of one that is being planned."""
        return json_bytes((await self._record(request, id)).json())

    async def forget(self, request: Request, id: str) -> Response:  # noqa: A002
        """Forget a front; one that is being planned ends with what was found, and is kept."""
        record = await self._record(request, id)
        if record.finished:
            await self._store.delete(record)
            return Response(status_code=204)
        return json_bytes((await self._engine.cancel(record)).json())

    async def events(self, request: Request, id: str) -> Response:  # noqa: A002
        """Tell how the planning of a front goes, until it has ended."""
        return event_stream(self._engine.watch(await self._record(request, id)))

    async def tour(self, request: Request, query: Annotated[TourQuery, Query()]) -> Response:
        """Give the tour of a front whose direction is nearest to an angle."""
        record = await self._record(request, query.front)
        if not record.front.tours:
            raise Refusal("no-tour", front=record.id)
        tour = record.front.nearest(query.angle)
        return json_bytes(b'{"front":' + to_json(record.id) + b"," + tour[1:])

    async def _record(self, request: Request, front: str | None) -> Record:
        caller, store = caller_of(request), self._store
        try:
            kept = store.latest(caller) if front is None else store.get(caller, front)
            return self._engine.state(await kept).record
        except NotFound:
            _refuse_unknown(front)
        except Expired:
            raise Refusal("front-expired", front=_named(front)) from None


def _refuse_unknown(front: str | None) -> NoReturn:
    if front is None:
        raise Refusal("no-front")
    raise Refusal("unknown-front", front=_named(front))


def _named(front: str | None) -> str:
    return "the latest" if front is None else repr(front[:80])
