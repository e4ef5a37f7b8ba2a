"""The route that says when an order can be promised: `POST /front/{id}/offers`."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace
from typing import Annotated, Any

from fastapi import APIRouter
from pydantic import BaseModel, Field
from starlette.requests import Request
from starlette.responses import Response

from service.api.auth import client_of
from service.api.body import receive_source
from service.api.body_budget import BodyBudget
from service.api.plan_responses import FleetObjectiveName, ReasonItem
from service.api.request_bodies import OFFERS_BODY
from service.api.responses import Lengths, ObjectiveName, compressed, json_bytes, problem_responses
from service.api.stored_fronts import find_stored
from service.api.task_parser import TaskParser
from service.jobs.store import Store
from service.requests.fields import Maybe, optional
from service.requests.task import Task

Measure = Callable[[Task], Awaitable[Task]]
_Slot = Annotated[list[float], Field(min_length=2, max_length=2)]


class ChoiceItem(BaseModel):
    """A place for the order in the plan, and its price."""

    rise: Lengths = Field(description="what each length of the plan grows by")
    vehicle: str = Field(description="the id of the type of the vehicle")
    shift: Maybe[int] = optional("the number of its shift, if its vehicle has several")
    route: Maybe[int] = optional(
        "the number of its route in the plan; none for a vehicle that does not leave without the"
        " order"
    )
    after: Maybe[str] = optional("the stop before the order; none where the route begins there")
    arrival: float = Field(description="when the vehicle arrives; it waits until the slot begins")


class OfferItem(BaseModel):
    """Whether the order can be visited in a slot, and at what price."""

    slot: _Slot = Field(description="when the visit may begin, from and to")
    possible: bool
    complete: Maybe[bool] = optional(
        "false where the time did not suffice for all places: another may be better"
    )
    rise: Maybe[Lengths] = optional(
        "the least that each length of the plan grows by: each of its own choice"
    )
    choices: Maybe[list[ChoiceItem]] = optional(
        "the places of which none is better in all objectives, up to five; the first one is the"
        " best compromise"
    )
    replan: Maybe[dict[str, Any]] = optional(
        "takes the offer: the request for `POST /front/{id}/replan` that adds the order in this"
        " slot"
    )
    reasons: Maybe[list[ReasonItem]] = optional(
        "if it is not possible: for each type of vehicles the rule that forbids it"
    )


class OffersAnswer(BaseModel):
    """The offers of an order beside the plan that is driven, in the order of the slots."""

    front: str = Field(description="the front's id")
    plan: int = Field(description="the number of the plan that is driven")
    objectives: list[FleetObjectiveName]
    clock: ObjectiveName = Field(description="the name and unit of all times")
    lengths: Lengths = Field(description="of the plan from now on, without the order")
    unassigned: list[str] = Field(description="the ids of stops that the plan leaves out")
    offers: list[OfferItem]
    timings_ms: dict[str, float]


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
            response_model=OffersAnswer,
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
