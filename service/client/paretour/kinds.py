"""The table of the kinds of fronts, named as by the member `kind` of answers."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from paretour.expect import members, text, unexpected
from paretour.plans import FleetFront, RobotFront, parse_fleet, parse_robots
from paretour.values import Front, parse_front

FrontOfAnyKind = Front | FleetFront | RobotFront
Routes = list[tuple[str, Sequence[Any]]]


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A kind of front.

    Args:
        parse: Returns the front in a JSON answer.
        routes: Returns the routes of an item, each as its mover and its visits; a tour is one
            route, without a mover.
        item: The name of an item of the front: a tour, or a plan with routes.
        mover: The name of what takes a route of a plan; empty for tours.
        visits: The name of what a route visits.
        counts: Return further numbers of a plan, by name.
    """

    parse: Callable[[Mapping[str, Any]], FrontOfAnyKind]
    routes: Callable[[Any], Routes]
    item: str = "plan"
    mover: str = ""
    visits: str = "stops"
    counts: Mapping[str, Callable[[Any], int]]


_TOURS = Kind(
    parse=parse_front,
    routes=lambda tour: [("", tour.stops or tour.tour.tolist())],
    item="tour",
    counts={},
)
KINDS: Mapping[str, Kind] = {
    "front": _TOURS,
    "coverage": _TOURS,
    "fleet": Kind(
        parse=parse_fleet,
        routes=lambda plan: [(route.vehicle, route.stops) for route in plan.routes],
        mover="vehicle",
        counts={
            "vehicles": lambda plan: len(plan.routes),
            "left out": lambda plan: len(plan.unassigned),
        },
    ),
    "robots": Kind(
        parse=parse_robots,
        routes=lambda plan: [(route.robot, route.tour.tolist()) for route in plan.routes],
        mover="robot",
        visits="places",
        counts={"robots": lambda plan: len(plan.routes)},
    ),
}


def kind_of(document: Mapping[str, Any]) -> Kind:
    """Return the kind of the front in a JSON answer; of tours if it names none, as in version 0.1.

    Raises:
        UnexpectedAnswer: The kind is unknown.
    """
    name = members(document, "answer").maybe("kind", text) or "front"
    if name not in KINDS:
        raise unexpected("answer/kind", f"one of {', '.join(KINDS)}", name)
    return KINDS[name]


def parse_any(document: Mapping[str, Any]) -> FrontOfAnyKind:
    """Return the front in a JSON answer, of any kind.

    Raises:
        UnexpectedAnswer: Its kind is unknown, or a member is missing or wrong.
    """
    return kind_of(document).parse(document)
