"""The route that says when an order can be promised: `POST /front/{id}/offers`."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace

from fastapi import APIRouter
from paretour.offers import Offers
from starlette.requests import Request
from starlette.responses import Response

from service.api.auth import client_of
from service.api.body import receive_source
from service.api.body_budget import BodyBudget
from service.api.request_bodies import OFFERS_BODY
from service.api.responses import compressed, json_bytes, problem_responses
from service.api.schemas import documented
from service.api.stored_fronts import find_stored
from service.api.task_parser import TaskParser
from service.jobs.store import Store
from service.requests.task import Task

Measure = Callable[[Task], Awaitable[Task]]


@dataclass(frozen=True, eq=False)
class OfferRoutes:
    """Says which slots an order can be promised in. Nothing is stored, and no plan is changed."""

    parser: TaskParser
    bodies: BodyBudget
    answers: BodyBudget
    most_bytes: int
    store: Store
    measure: Measure | None

    def router(self) -> APIRouter:
        """Return the route with its entry in the OpenAPI document."""
        router = APIRouter(tags=["fronts"])
        router.post(
            "/front/{id}/offers",
            response_model=documented(Offers),
            responses=problem_responses(400, 404, 408, 409, 410, 413, 415, 422, 502, 503, 504),
            openapi_extra={"requestBody": OFFERS_BODY},
        )(self.offer_slots)
        return router

    async def offer_slots(self, request: Request, id: str) -> Response:
        """Say in which slots an order can be promised, and what each costs the plan that is driven.

        For each slot: whether the order fits into the plan, the least rise of each objective, and
        the places of which none is better in everything. Other stops keep their vehicles and their
        order. Nothing is changed until an offer is taken: its `replan` is the request for
        `POST /front/{id}/replan`.
        """
        client = client_of(request)
        with self.bodies.open(client) as allowance:
            body = await receive_source(request, "replan", self.most_bytes, allowance)
            source, length = await find_stored(self.store, request, id, body)
            asked = await self.parser.offers(source, length, client)
            if asked.task.needs_roads and self.measure is not None:
                asked = replace(asked, task=await self.measure(asked.task))
            answer = await self.parser.find_offers(asked, client)
            with self.answers.open(client, len(answer), always=True) as sent:
                return sent.until_sent(await compressed(request, json_bytes(answer)))
