"""The routes that list, read, follow and forget fronts: `/front`, `/front/{id}`, `/tour`."""

from dataclasses import dataclass, replace
from typing import Annotated, Any

from fastapi import APIRouter, Query
from paretour.plans import FleetFront, RobotFront
from paretour.values import Front, Tour
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse

from service.api.answers import FrontsAnswer
from service.api.auth import caller_of, owner_of
from service.api.front_events import PARAMETERS, Seen, events_after
from service.api.geojson.answers import CONTENT, FRONT_CONTENT, FrontAnswers
from service.api.response_headers import LINK
from service.api.responses import (
    json_bytes,
    json_response,
    problem_responses,
    record_under,
    root_path_of,
)
from service.api.schemas import documented
from service.errors import Expired, NotFound, Refusal
from service.jobs.engine import Engine
from service.jobs.listing import ListedFront
from service.jobs.record import UNFINISHED, Record
from service.jobs.store import Store
from service.kinds.table import KINDS
from service.requests.fields import GEOMETRY, Geometry, Maybe, NonNegativeInteger
from service.requests.replan.way import ReplanSource, StoredFront, not_replannable
from service.requests.task import TaskSource
from service.requests.tour import TourQuery

PLAN = (
    "for a fleet's front in GeoJSON: the number of the plan whose routes are drawn, from 0; by"
    " default all plans are drawn"
)
_MOST_LISTED = 100
_LIMIT = "the most fronts of the answer"
_AFTER = "where the page begins, as the `Link` of the page before says; by default at the newest"
_QUICK = 8  # times as fast as a request stored tours are read
_LARGEST = 2**53  # above the numbers of all records, and exact in JSON


@dataclass(frozen=True, eq=False)
class StoredFrontRoutes:
    """Answers requests about stored fronts. Each caller sees only its own."""

    store: Store
    engine: Engine
    answers: FrontAnswers

    def router(self) -> APIRouter:
        """Return the routes with their entries in the OpenAPI document."""
        router = APIRouter(tags=["fronts"])
        missing = problem_responses(404, 410, 503)
        stream: dict[str, Any] = {"description": "The events", "content": {"text/event-stream": {}}}
        router.get(
            "/front",
            response_model=documented(FrontsAnswer),
            responses={200: {"headers": LINK}, **problem_responses(422, 503)},
        )(self.list_fronts)
        router.get(
            "/front/{id}",
            response_model=documented(Front | FleetFront | RobotFront),
            responses={200: FRONT_CONTENT, **problem_responses(404, 406, 410, 422, 502, 503, 504)},
        )(self.get_front)
        router.delete(
            "/front/{id}",
            response_model=documented(Front | FleetFront | RobotFront),
            responses={204: {"description": "Forgotten"}, **missing},
        )(self.forget_front)
        router.get(
            "/front/{id}/events",
            response_class=StreamingResponse,
            responses={
                200: stream,
                204: {"description": "Finished, as the client knows"},
                **missing,
            },
            openapi_extra={"parameters": list(PARAMETERS)},
        )(self.follow_front)
        router.get(
            "/tour",
            response_model=documented(Tour),
            responses={200: CONTENT, **problem_responses(404, 406, 410, 422, 502, 503, 504)},
        )(self.get_tour)
        return router

    async def list_fronts(
        self,
        request: Request,
        limit: Annotated[int, Query(ge=1, le=_MOST_LISTED, description=_LIMIT)] = 20,
        after: Annotated[int, Query(ge=1, le=_LARGEST, description=_AFTER)] = _LARGEST,
    ) -> Response:
        """List the caller's own fronts, the newest first: of its key or, without keys, its address.

        A front is listed once it is submitted, and moves to the top when it is finished. If there
        are more than `limit`, the header `Link` has the address of the next page.
        """
        caller = caller_of(request)
        found = await self.store.fronts(caller, owner_of(request), after, limit + 1)
        page = found[:limit]
        present = [await self._present(caller, each) for each in page]
        response = json_response({"fronts": [each.document() for each in present]})
        if len(found) > limit:
            address = f"{root_path_of(request.scope)}/front?limit={limit}&after={page[-1].number}"
            response.headers["Link"] = f'<{address}>; rel="next"'
        return response

    async def get_front(
        self,
        request: Request,
        id: str,
        geometry: Annotated[Geometry, Query(description=GEOMETRY)] = "straight",
        plan: Annotated[Maybe[NonNegativeInteger], Query(description=PLAN)] = None,
    ) -> Response:
        """Return a front; while it is being planned, the best so far."""
        record = await self._record(request, id)
        return await self.answers.front(request, record, geometry, plan=plan)

    async def forget_front(self, request: Request, id: str) -> Response:
        """Delete a front. One that is being planned is stopped, and kept with what it has found."""
        record = await self._record(request, id)
        if record.finished:
            await self.store.delete(record)
            return Response(status_code=204)
        cancelled = await self.engine.cancel(record)
        return json_bytes(record_under(root_path_of(request.scope), cancelled).json())

    async def follow_front(self, request: Request, id: str) -> Response:
        """Send the progress of a front as events, until it is finished.

        With `Last-Event-ID` the events go on after that one. Once a client knows that the front is
        finished, the answer is 204, at which browsers connect no more.
        """
        record = await self._record(request, id)
        seen = Seen.read(request.headers.get("last-event-id"))
        if seen.has_end(record):
            return Response(status_code=204)
        events = events_after(self.engine.watch(record), seen)
        headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
        return StreamingResponse(events, media_type="text/event-stream", headers=headers)

    async def get_tour(self, request: Request, query: Annotated[TourQuery, Query()]) -> Response:
        """Return one tour of a front: at an angle or balance, by weights or budgets, or a knee."""
        query.check()
        record = await self._record(request, query.front)
        if KINDS[record.front.kind].mover:
            raise Refusal("no-tours", front=record.id)
        if not record.front.tours:
            raise Refusal("no-tour", front=record.id)
        names = [each["name"] for each in record.front.objectives or ()]
        index = query.choose(record.front.lengths, record.front.directions, names)
        return await self.answers.tour(request, record, index, query.geometry)

    async def _present(self, caller: str, listed: ListedFront) -> ListedFront:
        """Return what is known of a front now: the engine may know more than the store."""
        if listed.status not in UNFINISHED:
            return listed
        try:
            stored = await self.store.get(caller, listed.id)
        except (NotFound, Expired):  # deleted meanwhile
            return listed
        record = self.engine.state(stored).record
        return replace(listed, front=record.front, status=record.status)

    async def _record(self, request: Request, id: str | None) -> Record:
        """Return the present state of the caller's record with an id, or of its latest record."""
        return self.engine.state(await find_record(self.store, request, id)).record


async def find_record(store: Store, request: Request, id: str | None) -> Record:
    """Return the caller's record with an id, as it is stored; without an id its latest.

    Callers without a key share their fronts, but each address has its own latest front.

    Raises:
        Refusal: The front does not exist, or no longer.
    """
    caller = caller_of(request)
    try:
        if id is None:
            return await store.latest(caller, owner_of(request))
        return await store.get(caller, id)
    except NotFound:
        if id is None:
            raise Refusal("no-front") from None
        raise Refusal("unknown-front", front=repr(id[:80])) from None
    except Expired:
        name = "the latest" if id is None else repr(id[:80])
        raise Refusal("front-expired", front=name) from None


async def find_stored(
    store: Store, request: Request, id: str, body: TaskSource
) -> tuple[ReplanSource, int]:
    """Return a request about a finished front of the caller, and the bytes that there are to parse.

    Raises:
        Refusal: The front does not exist, or cannot be replanned.
    """
    record = await find_record(store, request, id)
    if not record.finished:
        raise not_replannable(record.id, "it is still being planned")
    task = await store.task(record)
    if task is None:
        reason = "what it was planned from is not kept; plan what is left with POST /front"
        raise not_replannable(record.id, reason)
    source = ReplanSource(body.body, StoredFront(record.id, task, record.front))
    return source, body.length + len(task) + len(record.front.tours) // _QUICK
