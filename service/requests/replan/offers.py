"""Requests of `POST /front/{id}/offers`: their fields, and what is asked for of which fleet."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any

from paretour.choice import knee
from pydantic import ConfigDict, Field
from pydantic_core import from_json, to_json

from service.actor_info import ActorInfo
from service.errors import Fault, Refusal, invalid
from service.errors.parts import Part, part_of, renamed
from service.fleet.checks import check_loads
from service.fleet.vehicles import Span
from service.requests.fields import (
    PositiveTime,
    StrictModel,
    Time,
    at_most,
    empty_list,
    one_of,
    optional,
)
from service.requests.fleet_fields import TimeSpan
from service.requests.limits import Limits, check_limit
from service.requests.replan.fleet_fields import FleetChanges, NewFleetStop
from service.requests.replan.rest_of_fleet import rest_of_fleet
from service.requests.replan.way import ReplanSource
from service.requests.task import Task, UnmeasuredFleet
from service.requests.validation import parse_json

MOST_SLOTS = 200
_MOST_BYTES = 2**23  # of all requests to replan in an answer, each with the order
_OF_SLOTS = ("window", "windows", "prize")  # what an order must not have beside slots


def _without_windows(schema: dict[str, Any]) -> None:
    """Leave out of a JSON schema what an order must not have."""
    for name in _OF_SLOTS:
        del schema["properties"][name]


class OfferedOrder(NewFleetStop):
    """An order whose time is not agreed yet: a stop without windows and without a prize."""

    model_config = ConfigDict(json_schema_extra=_without_windows)


class EverySlot(StrictModel):
    """Slots of equal length, one after another, in the unit of the clock."""

    begin: Time = Field(alias="from", description="when the first slot begins")
    end: Time = Field(alias="to", description="when the last slot ends, at the latest")
    length: PositiveTime = Field(description="how long each slot is")
    step: PositiveTime | None = optional(
        "the time from the begin of a slot to that of the next; by default the length, so that"
        " slots do not overlap"
    )

    def spans(self) -> list[Span]:
        """Return the slots.

        Raises:
            Refusal: There is none, or there are too many.
        """
        step = self.length if self.step is None else self.step
        last = self.begin + self.length
        if last > self.end:
            raise invalid("every/to", "no-slot", least=last, came=self.end)
        count = int((self.end - last) / step) + 1
        _check_count("every/length", count, MOST_SLOTS)
        begins = [self.begin + number * step for number in range(count)]
        return [(begin, begin + self.length) for begin in begins]


class OffersRequest(FleetChanges):
    """An order without a time, the slots to choose from, and what has changed since the plan."""

    model_config = one_of("slots", "every")

    order: OfferedOrder = Field(
        description="the order, in the form of an added stop; its costs are those of the last one"
        " that is added"
    )
    slots: Annotated[list[TimeSpan], at_most(MOST_SLOTS)] = empty_list(
        "when the visit may begin, from and to, in the unit of the clock: one offer for each, up to"
        " 200"
    )
    every: EverySlot | None = optional("in place of slots: those of a day, or of several")
    now: Time | None = optional("the present time; by default 0, before any vehicle has left")
    time_limit: Annotated[float, Field(ge=0, allow_inf_nan=False)] = Field(
        default=1.0, description="the most seconds to look for places; then the best so far count"
    )

    def spans(self) -> list[Span]:
        """Return the slots.

        Raises:
            Refusal: There is none, or one ends before it begins.
        """
        if bool(self.slots) == (self.every is not None):
            given = "both" if self.slots else "none"
            fault = Fault(
                "one-form", pointer="/slots", values={"forms": "slots and every", "given": given}
            )
            raise Refusal("invalid-request", errors=[fault])
        if self.every is not None:
            return self.every.spans()
        for index, (begin, end) in enumerate(self.slots):
            if end < begin:
                raise invalid(f"slots/{index}", "ends-early", begin=begin, end=end)
        return [(begin, end) for begin, end in self.slots]


@dataclass(frozen=True, eq=False)
class OffersTask:
    """What offers are asked for, checked.

    Args:
        task: The rest of the fleet's day, with the order as a stop that may be visited at any time.
        order: The index of the order among its stops.
        slots: When the visit may begin, from and to.
        seconds: The most seconds to look for places.
        plan: The number of the plan that is driven.
        routes: The number of the route that has each stop in that plan, by the id of the stop.
        replan: The members of the request to replan that adds the order, without its window.
    """

    front: str
    task: Task
    order: int
    slots: tuple[Span, ...]
    seconds: float
    plan: int
    routes: Mapping[str, int]
    replan: Mapping[str, Any]

    def replan_in(self, slot: Span) -> dict[str, Any]:
        """Return the members of the request to replan that adds the order in a slot."""
        *others, order = self.replan["add"]
        return {**self.replan, "add": [*others, {**order, "window": list(slot)}]}


def offers_task(
    fleet: UnmeasuredFleet,
    task: Task,
    source: ReplanSource,
    limits: Limits,
    actors: Mapping[str, ActorInfo],
) -> OffersTask:
    """Return what a request asks for about a front of a fleet.

    Raises:
        Refusal: The request is malformed or over a limit, the fleet has no clock, or the front
            cannot be replanned so.
    """
    request = parse_json(OffersRequest, source.body)
    if "time_limit" in request.model_fields_set:
        check_limit("time_limit", limits.seconds, request.time_limit)
    _check_order(request.order, fleet)
    slots = request.spans()
    if fleet.rules.clock is None:
        raise invalid("every" if request.every else "slots", "fleet-has-no-clock")
    members = _members_of_replan(request, source)
    most = max(1, _MOST_BYTES // len(to_json(members["add"][-1])))
    _check_count("every/length" if request.every else "slots", len(slots), most)
    try:
        asked = ReplanSource(to_json(members), source.front)
        rest = rest_of_fleet(fleet, task, asked, limits, actors)
    except Refusal as refusal:
        raise _of_order(refusal, len(request.add)) from None
    labels = rest.labels
    assert labels is not None
    order = [stop.id for stop in labels.stops].index(request.order.id)
    parts = ["order" if stop == order else part for stop, part in enumerate(labels.parts or ())]
    return OffersTask(
        front=source.front.id,
        task=replace(rest, labels=replace(labels, parts=tuple(parts))),
        order=order,
        slots=tuple(slots),
        seconds=min(request.time_limit, limits.seconds),
        plan=members["plan"],
        routes=_routes_of(source.front.found.split()[members["plan"]]),
        replan=members,
    )


def _members_of_replan(request: OffersRequest, source: ReplanSource) -> dict[str, Any]:
    """Return the members of the request to replan that adds the order, as the caller wrote them."""
    given = from_json(source.body)
    own = {*OffersRequest.model_fields} - {*FleetChanges.model_fields}
    members = {name: value for name, value in given.items() if name not in own}
    number = request.plan
    if number is None:
        lengths = source.front.found.lengths
        number = knee(lengths) if len(lengths) else 0
    added = [*(members.pop("add", None) or ()), given["order"]]
    return {**members, "plan": number, "now": request.now or 0.0, "add": added}


def _check_order(order: OfferedOrder, fleet: UnmeasuredFleet) -> None:
    """Raise a refusal of an order that has a time already, or a load of other dimensions."""
    for name in _OF_SLOTS:
        if name in order.model_fields_set:
            raise invalid(f"order/{name}", "not-beside", member="slots")
    loads = {"demand": order.demand, "pickup": order.pickup}
    check_loads(loads, "order", fleet.rules.dimensions)


def _check_count(part: str, count: int, most: int) -> None:
    if count > most:
        raise invalid(part, "too-many-slots", limit=most, came=count)


def _of_order(refusal: Refusal, added: int) -> Refusal:
    """Return a refusal in which what is wrong with the last added stop is wrong with the order."""
    known = f"add/{added}"

    def rename(path: str) -> Part:
        is_order = path == known or path.startswith(f"{known}/")
        return part_of(f"order{path.removeprefix(known)}" if is_order else path)

    return renamed(refusal, rename)


def _routes_of(plan: bytes) -> dict[str, int]:
    """Return the number of the route that visits each stop of a plan, by its id."""
    routes = from_json(plan)["routes"]
    return {stop: number for number, route in enumerate(routes) for stop in route["stops"]}
