"""How a front that is asked for is answered: at once or later, and to a repeat the same."""

import asyncio
import hashlib
import uuid
from http import HTTPStatus

from pydantic_core import to_json
from starlette.requests import Request
from starlette.responses import Response

from service.api.body import json_bytes, json_response
from service.api.request_headers import idempotency_key, wants_it_later
from service.errors import MEDIA_TYPE
from service.jobs.engine import Engine, finished
from service.jobs.front_document import Rendered
from service.jobs.messages import Work
from service.jobs.record import Record
from service.jobs.store import Store


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
            Busy: the queue is full.
            Closed: no more work is taken.
        """
        await self._engine.check_open()
        if idempotency_key(request) is None:
            await self._engine.check_place()

    async def answer(self, request: Request, work: Work, nothing_yet: Rendered) -> Response:
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
            front=nothing_yet,
            work=work,
            key=key,
            digest=await asyncio.to_thread(_digest, work) if key else "",
        )
        if wants_it_later(request):
            return _accepted(self._engine.state(await self._begun(record)).record)
        if record.key is not None:
            return _finished(request, await finished(self._engine, await self._begun(record)))
        return _finished(request, await self._now(request, record))

    async def _now(self, request: Request, record: Record) -> Record:
        leaving = asyncio.ensure_future(_left(request))
        try:
            return await self._engine.at_once(record, leaving)
        finally:
            leaving.cancel()

    async def _begun(self, record: Record) -> Record:
        """The record, or the earlier one of which it is a repeat."""
        kept = await self._store.admit(record)
        if kept.id == record.id:
            try:
                await self._engine.begin(record)
            except Exception:
                await self._store.forget(record)
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
    problem = {**record.problem, "request_id": request.scope["request_id"]}
    status: int = problem["status"]
    headers = {"Retry-After": "1"} if status == HTTPStatus.SERVICE_UNAVAILABLE else {}
    return Response(to_json(problem), status, headers, MEDIA_TYPE)


def _digest(work: Work) -> str:
    digest = hashlib.sha256()
    for part in (work.kind.encode(), work.body, work.upload or b""):
        digest.update(b"%d:" % len(part))
        digest.update(part)
    return digest.hexdigest()
