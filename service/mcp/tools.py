"""Define the tools. Each one calls the service by the client, and returns a short text."""

from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from paretour import AsyncClient, FrontOfAnyKind, Plan, Refused, replan_plan
from paretour.choice import choose
from pydantic import BaseModel, ValidationError

from service.amounts.read import budget_in
from service.mcp.arguments import (
    Arguments,
    AskAbout,
    Changes,
    ChooseTour,
    DayOfFleet,
    Members,
    PlanFile,
    StoredFront,
    schema_of,
)
from service.mcp.changes import changes_of
from service.mcp.offers import offers_text
from service.mcp.routes import names_of
from service.mcp.summaries import explanation, front_text, question_text, tour_text, unreadable_text
from service.mcp.times import clock_unit, with_times
from service.requests.fleet import FleetRequest
from service.requests.front import FrontRequest
from service.requests.null_members import without_null_members
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from service.requests.replan.offers import OffersRequest
from service.requests.validation import refusal_of

# A front is parsed in the event loop of the service. For this number of stops that takes 50 ms.
_MOST_STOPS = 100_000  # in all tours of a front
_MOST_TOURS = 100  # of a front by default


@dataclass(frozen=True)
class Planner:
    """A service that tools call.

    Args:
        page: The address of its page, if it has one.
        state: Say what the service does before it plans, as compiling; by default nothing.
    """

    client: AsyncClient
    page: str | None = None
    state: Callable[[], Awaitable[str]] | None = None

    async def planned(self, plan: Plan, stops: int, assumed: Sequence[str] = ()) -> str:
        """Plan a front, and return its text.

        Args:
            plan: The path and the request. A front of many stops gets fewer tours by default.
            stops: The number of stops; 0 if it is not known.
            assumed: Sentences that say how a file was read, for the text.
        """
        if stops * _MOST_TOURS > _MOST_STOPS:
            plan = replace(plan, request={"size": max(5, _MOST_STOPS // stops), **plan.request})
        front = await self.client.plan_any(plan)
        return front_text(front, self.link(front), assumed)

    async def stored(self, front: str) -> FrontOfAnyKind:
        """Return a front that was planned before."""
        return await self.client.any_job(front).front()

    def link(self, front: FrontOfAnyKind) -> str | None:
        """Return the address of the page that shows a front; None if there is none."""
        return None if self.page is None else f"{self.page.rstrip('/')}/#front={front.id}"


Run = Callable[[Planner, Any], Awaitable[str]]


@dataclass(frozen=True, kw_only=True)
class Tool:
    """A tool: its name and description for an agent, its arguments, and the function it runs.

    Args:
        forms: The forms that have the arguments as members and check them in the service.
    """

    name: str
    description: str
    arguments: type[Arguments]
    run: Run
    forms: tuple[type[BaseModel], ...] = ()
    reads_only: bool = False

    @property
    def schema(self) -> dict[str, Any]:
        """The JSON schema of the arguments."""
        return schema_of(*(self.forms or (self.arguments,)))

    async def call(self, planner: Planner, arguments: Mapping[str, Any]) -> str:
        """Return the answer to a call.

        Raises:
            Refusal: The arguments do not match their schema.
            Refused: The service refuses the request.
            ValueError: The front has no tour for this choice, or the choice is not valid.
        """
        try:
            parsed = self.arguments.model_validate(
                without_null_members(self.arguments, dict(arguments))
            )
        except ValidationError as error:
            schema = self.arguments.model_json_schema()
            raise refusal_of(error.errors(include_url=False), schema=schema) from None
        return await self.run(planner, parsed)


async def _plan_front(planner: Planner, asked: Members) -> str:
    request = with_times(asked.members, "s", FrontRequest)
    return await planner.planned(Plan("/front", request), _most_stops(request))


async def _plan_fleet(planner: Planner, asked: Members) -> str:
    request = with_times(asked.members, clock_unit(asked.members), FleetRequest)
    return await planner.planned(Plan("/fleet", request), _most_stops(request))


def _most_stops(members: Mapping[str, Any]) -> int:
    """Return the number of stops in a request that is not checked yet."""
    matrices = members.get("matrices")
    first = matrices[0] if isinstance(matrices, list) and matrices else None
    rows = (members.get("stops"), members.get("coordinates"), first)
    return max(len(each) if isinstance(each, list) else 0 for each in rows)


async def _plan_file(planner: Planner, asked: PlanFile) -> str:
    contents = asked.contents
    first = next(iter(contents))
    columns = [{**each.model_dump(), "file": each.file or first} for each in asked.columns or ()]
    try:
        found = await planner.client.read_files(contents, columns)
    except Refused as error:
        raise ValueError(unreadable_text(error)) from None
    request = dict(found["request"])
    if asked.time_limit is not None:
        request["time_limit"] = asked.time_limit
    notes = [str(note.get("text", "")) for note in found["notes"]]
    return await planner.planned(Plan(f"/{found['kind']}", request), _most_stops(request), notes)


async def _explain_front(planner: Planner, asked: StoredFront) -> str:
    front = await planner.stored(asked.front)
    return explanation(front, planner.link(front))


async def _choose_tour(planner: Planner, asked: ChooseTour) -> str:
    front = await planner.stored(asked.front)
    number = asked.number
    if number is None:
        number = _chosen(front, asked)
    elif number >= len(front):
        raise ValueError(f"number must be below {len(front)}, got {number}")
    return tour_text(front, number, asked.first_stop, planner.link(front))


def _chosen(front: FrontOfAnyKind, asked: ChooseTour) -> int:
    """Return the number of the tour that is chosen by a budget, weights, the knee or a balance."""
    names = [each.name for each in front.objectives or ()]
    no_angles = np.empty(0)  # agents do not choose by them
    ways = asked.model_dump()
    if asked.at_most:
        ways["at_most"] = {name: _budget(front, name, most) for name, most in asked.at_most.items()}
    return choose(front.lengths, no_angles, names, ways)


def _budget(front: FrontOfAnyKind, name: str, budget: float | str) -> float:
    """Return a budget as a number in the unit of its objective, by name or by number."""
    names = names_of(front)
    index = names.index(name) if name in names else int(name) if name.isdecimal() else len(names)
    if index >= len(names) or not len(front):
        return 0.0  # which is refused by the name
    unit = front.objectives[index].unit if front.objectives else None
    return budget_in(budget, float(front.lengths[:, index].min()), unit)


async def _ask(planner: Planner, asked: AskAbout) -> str:
    front, picks = await planner.stored(asked.front), asked.picks or []
    question = front.ask(picks, questions=asked.questions, options=asked.options)
    if question.chosen is None:
        return question_text(front, question, picks)
    return tour_text(front, question.chosen, 0, planner.link(front))


async def _offer_slots(planner: Planner, asked: Changes) -> str:
    day = changes_of(await planner.stored(asked.front), asked.members)
    with day.refused_in_its_words():
        offers = await planner.client.offers(asked.front, **cast(Any, day.members))
    return offers_text(offers, day.assumed)


async def _replan(planner: Planner, asked: Changes) -> str:
    day = changes_of(await planner.stored(asked.front), asked.members)
    with day.refused_in_its_words():
        return await planner.planned(
            replan_plan(asked.front, cast(Any, day.members)), 0, day.assumed
        )


TOOLS = (
    Tool(
        name="plan_front",
        description="Plan tours through stops under two to four objectives, such as time against"
        " distance. The answer is the front of all best trade-offs: its id, the range of each"
        " objective, and up to five tours.",
        arguments=Members,
        forms=(FrontRequest,),
        run=_plan_front,
    ),
    Tool(
        name="plan_file",
        description="Plan what the text of a file describes: stops, a fleet, or an instance of"
        " TSPLIB and the like; or several files together. The answer is as of plan_front, with what"
        " was assumed.",
        arguments=PlanFile,
        run=_plan_file,
    ),
    Tool(
        name="plan_fleet",
        description="Plan routes of several vehicles, with capacities, time windows and shipments,"
        " under two to four objectives. The answer is a front of plans: of the knee each route"
        " with its times of day, lengths and load. Times are in the unit of the clock, or 10:00.",
        arguments=Members,
        forms=(FleetRequest,),
        run=_plan_fleet,
    ),
    Tool(
        name="explain_front",
        description="Explain what a planned front trades: the range of each objective, its knee,"
        " and what a few per cent more of one objective buys of another.",
        arguments=StoredFront,
        run=_explain_front,
        reads_only=True,
    ),
    Tool(
        name="choose_tour",
        description="Choose one tour of a planned front, and read its stops in order: within"
        " budgets, by weights, at the knee, at a balance, or by its number.",
        arguments=ChooseTour,
        run=_choose_tour,
        reads_only=True,
    ),
    Tool(
        name="ask",
        description="Help a person choose, by three questions: each offers three options, none"
        " worse in anything than where the person stands. Show the options, ask which is best, and"
        " call again with all picks; at the end the answer is the tour or plan.",
        arguments=AskAbout,
        run=_ask,
        reads_only=True,
    ),
    Tool(
        name="offer_slots",
        description="Say when an order without a time can be promised, beside the plan of a fleet"
        " that is driven: which slots are possible, and what each costs. Nothing is changed; replan"
        " with the order in add, and the slot as its window, takes an offer.",
        arguments=Changes,
        forms=(Changes, DayOfFleet, OffersRequest),
        run=_offer_slots,
        reads_only=True,
    ),
    Tool(
        name="replan",
        description="Plan the rest of a tour or of a fleet's day when stops are done, added or"
        " removed, the vehicle is elsewhere or broken down, or costs have changed. What is added to"
        " a fleet has demand, service and window as stops of plan_fleet have. The answer is a new"
        " front; the earlier one stays as it is.",
        arguments=Changes,
        forms=(Changes, DayOfFleet, ReplanRequest, ReplanFleetRequest),
        run=_replan,
    ),
)
