"""Declare the answers that the client, `paretour`, does not: it has fronts and what is in them."""

from paretour.described import answer, member
from paretour.fronts import FleetObjective, Objective
from paretour.listing import ListedFront
from paretour.plans import FleetPlan, RobotPlan
from paretour.questions import Option
from paretour.values import Actor, CoverageItem, Front, TourItem


@answer("CoverageAnswer")
class CoverageAnswer(Front):
    """A front of tours through places on a map, by ascending length."""


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
    objectives: tuple[FleetObjective | Objective, ...] | None = member("as the request names them")
    number: int | None = member("at the end: the number in the front, from 0")
    tour: CoverageItem | TourItem | None = member("at the end, of a front of tours")
    plan: FleetPlan | RobotPlan | None = member("at the end, of a front of plans")
