"""Declare the answers about fronts, as the OpenAPI document has them.

The objects in them, such as tours and routes, are declared by the client, `paretour`.
"""

from collections.abc import Mapping
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from paretour.described import Lengths, Shape, answer, member
from paretour.fronts import Objective, RequestNote
from paretour.listing import ListedFront
from paretour.plans import FleetPlan, RobotPlan
from paretour.questions import Option
from paretour.values import Actor, ActorName, CoverageItem, TourItem, Uncovered

from service.api.problem import Problem
from service.fleet.measures.table import Measure
from service.fleet.rules import Over
from service.front import Termination
from service.jobs.record import Status
from service.requests.stop_fields import NamedStop
from service.requests.task import KindName

AS_NAMED = "as the request names them"


@answer("FleetObjectiveName", kw_only=False)
class FleetObjective(Objective):
    """An objective of a fleet's front."""

    over: Over = member("whether the routes of a plan are added, or the longest counts")
    measure: Measure | None = member("of plans, if it is not of costs")


@answer("FrontAnswer")
class FrontAnswer:
    """A front of tours, by ascending first length."""

    id: str
    status: Status
    problem: Problem | None = member("why it failed")
    kind: KindName = member("front, coverage, fleet or robots: what was planned")
    cities: int
    front: tuple[TourItem, ...]
    points: int = member("nondominated points found; front holds at most `size`")
    hypervolume: float = member("of the front returned, 0 to 1")
    hypervolume_bound: float | None = member(
        "an upper bound for every front of this instance, if `bound` is true", always=True
    )
    reference_point: Lengths | None = member(
        "null, like the scale, until the costs are measured", always=True
    )
    scale: Lengths | None = member(always=True)
    actor: ActorName | None = member("null where no network built tours, or none yet", always=True)
    timings_ms: Mapping[str, float] = member(
        "milliseconds of each phase of planning; once it has ended, first those in the queue, and"
        " last all since the request"
    )
    terminated: Termination | None = member(
        "how the search ended, null while it goes on. `converged`: up to eleven cities"
        " all tours were compared, and the front is exact; beyond, the search has long found"
        " nothing better in its neighbourhoods, which proves nothing. Where `time_limit` is 0 there"
        " was no search, and it says that all tours asked for were built",
        always=True,
    )
    closed: bool | None = member("false where tours are open routes, left out where closed")
    objectives: tuple[Objective, ...] | None = member(AS_NAMED)
    stops: tuple[NamedStop, ...] | None = member("as the request has them")
    notes: tuple[RequestNote, ...] | None = member(
        "what is likely to be a mistake in the request, if anything is"
    )


@answer("MapAnswer")
class MapAnswer(FrontAnswer):
    """A front of anything on a map."""

    places: Annotated[NDArray[np.int64], Shape(None, 2)] = member("row and column of each")
    uncovered: Uncovered | None = member(
        "the free cells that no path leads to, once the map is surveyed"
    )


@answer("CoverageAnswer")
class CoverageAnswer(MapAnswer):
    """A front of tours through places on a map, by ascending length."""

    front: tuple[CoverageItem, ...]


@answer("FleetAnswer")
class FleetAnswer(FrontAnswer):
    """A front of plans for a fleet, by ascending first length."""

    front: tuple[FleetPlan, ...]  # type: ignore[assignment]  # for reading only
    objectives: tuple[FleetObjective, ...]
    stops: tuple[NamedStop, ...]
    clock: Objective | None = member("the name and unit of all times, if there is a clock")
    driven: Lengths | None = member(
        "of a replanned fleet: the lengths of the rest of the plan that is driven, without new"
        " stops, if it keeps every rule"
    )


@answer("RobotsAnswer")
class RobotsAnswer(MapAnswer):
    """A front of plans for several robots on a map, by ascending first length."""

    front: tuple[RobotPlan, ...]  # type: ignore[assignment]  # for reading only
    objectives: tuple[FleetObjective, ...]


@answer("FrontsAnswer")
class FrontsAnswer:
    """A page of the caller's fronts, the newest first; `Link` leads to the next page."""

    fronts: tuple[ListedFront, ...]


@answer("ActorsAnswer")
class ActorsAnswer:
    """The networks to choose from."""

    actors: tuple[Actor, ...]


@answer("QuestionAnswer")
class QuestionAnswer(Option):
    """A question: where the picks have led, and the options; at the end a tour or a plan."""

    front: str = member("the front's id")
    left: int = member("how many questions are left, this one included; 0 at the end")
    options: tuple[Option, ...] = member("by ascending first length; none at the end")
    objectives: tuple[FleetObjective | Objective, ...] | None = member(AS_NAMED)
    number: int | None = member("at the end: the number in the front, from 0")
    tour: CoverageItem | TourItem | None = member("at the end, of a front of tours")
    plan: FleetPlan | RobotPlan | None = member("at the end, of a front of plans")
