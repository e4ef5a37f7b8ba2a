"""The course of a job as server-sent events."""

import asyncio
from collections.abc import AsyncIterator, Mapping

from fastapi.sse import KEEPALIVE_COMMENT, format_sse_event
from pydantic_core import to_json
from starlette.responses import StreamingResponse

from service.jobs.engine import State
from service.jobs.messages import Snapshot
from service.jobs.record import Record

HEARTBEAT = 15.0  # seconds of silence before a comment says that the stream is alive


def event_stream(states: AsyncIterator[State]) -> StreamingResponse:
    """An answer that goes on until the job is finished."""
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return StreamingResponse(_events(states), media_type="text/event-stream", headers=headers)


async def _events(states: AsyncIterator[State]) -> AsyncIterator[bytes]:
    status, progress = None, None
    async for state in _with_heartbeats(states):
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


async def _with_heartbeats(states: AsyncIterator[State]) -> AsyncIterator[State | None]:
    """The states, and none for each while without."""
    coming = asyncio.ensure_future(anext(states, None))
    try:
        while True:
            done, _ = await asyncio.wait([coming], timeout=HEARTBEAT)
            if not done:
                yield None
                continue
            state = coming.result()
            if state is None:
                return
            coming = asyncio.ensure_future(anext(states, None))
            yield state
    finally:
        coming.cancel()


def _status(record: Record) -> bytes:
    return _event("status", {"id": record.id, "status": record.status})


def _progress(snapshot: Snapshot) -> bytes:
    told = {
        "seconds": snapshot.seconds,
        "hypervolume": snapshot.hypervolume,
        "points": snapshot.points,
    }
    return _event("progress", told)


def _event(name: str, data: Mapping[str, object]) -> bytes:
    return format_sse_event(event=name, data_str=to_json(data).decode())
