"""Answer which slots an order can be promised in, beside a fleet's plan that is driven."""

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic_core import to_json

from service.errors import Refusal
from service.fleet.evaluation import unassigned
from service.fleet.necessary import check_left
from service.fleet.plans import Plan
from service.kinds.kind import Actors
from service.kinds.parsing import stored_task
from service.offers.offers import Choice, Offer, Offers, find_offers
from service.requests.limits import Limits
from service.requests.replan.offers import OffersTask, offers_task
from service.requests.replan.way import ReplanSource
from service.requests.task import UnmeasuredFleet
from service.watch import Watch


def parse_offers(source: ReplanSource, limits: Limits, actors: Actors) -> OffersTask:
    """Return what a request for offers about a stored front asks for.

    Raises:
        Refusal: The request is malformed or over a limit, or the front is not of a fleet.
    """
    task = stored_task(source.front)
    if not isinstance(task.subject, UnmeasuredFleet):
        raise Refusal("no-offers", front=source.front.id)
    return offers_task(task.subject, task, source, limits, actors)


def answer_offers(asked: OffersTask, _limits: Limits, _actors: Actors) -> bytes:
    """Return the offers, whose costs by road have been measured, as JSON."""
    watch: Watch[None] = Watch()
    subject = asked.task.subject
    assert isinstance(subject, UnmeasuredFleet)
    check_left(subject.rules)
    ended = watch.lasting(asked.seconds).ended
    found = find_offers(subject.fleet(), Plan(subject.driven), asked.order, asked.slots, ended)
    timings = {**asked.task.timings, "offers": 1000 * watch.spent}
    return to_json(_members(asked, subject, found, timings))


def _members(
    asked: OffersTask, subject: UnmeasuredFleet, found: Offers, timings: Mapping[str, float]
) -> dict[str, Any]:
    labels = asked.task.labels
    assert labels is not None
    named = subject.members(labels)
    ids = [stop.id for stop in labels.stops]
    left_out = [s for s in unassigned(subject.rules, found.plan) if s != asked.order]
    return {
        "front": asked.front,
        "plan": asked.plan,
        "objectives": named["objectives"],
        "clock": named["clock"],
        "lengths": list(found.lengths),
        "unassigned": [ids[stop] for stop in left_out],
        "offers": [_offer(asked, subject, found.plan, each, ids) for each in found.offers],
        "timings_ms": dict(timings),
    }


def _offer(
    asked: OffersTask, subject: UnmeasuredFleet, plan: Plan, offer: Offer, ids: Sequence[str]
) -> dict[str, Any]:
    members = {"slot": list(offer.slot), "possible": bool(offer.choices)}
    if not offer.complete:
        members["complete"] = False
    if offer.rise is None:
        reasons = [
            {"vehicle": subject.vehicles[number].id, "rule": broken.rule, "detail": broken.detail}
            for number, broken in offer.reasons
        ]
        return {**members, "reasons": reasons}
    choices = [_choice(asked, subject, plan, choice, ids) for choice in offer.choices]
    replan = asked.replan_in(offer.slot)
    return {**members, "rise": list(offer.rise), "choices": choices, "replan": replan}


def _choice(
    asked: OffersTask, subject: UnmeasuredFleet, plan: Plan, choice: Choice, ids: Sequence[str]
) -> dict[str, Any]:
    name = subject.vehicles[choice.vehicle]
    stops = () if choice.number is None else plan.routes[choice.number].stops
    clients = [ids[stop] for stop in stops if stop not in subject.rules.depots]
    known = (asked.routes[each] for each in clients if each in asked.routes)
    route = next(known, None) if name.route is None else name.route
    after = None if choice.after is None else ids[choice.after]
    members = {"shift": name.shift, "route": route, "after": after}
    return {
        "rise": list(choice.rise),
        "vehicle": name.id,
        **{member: value for member, value in members.items() if value is not None},
        "arrival": choice.arrival,
    }
