"""Fronts of plans for several robots on a map, as immutable values."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from paretour.expect import count, each, floats, indexes, members, number, text
from paretour.values import (
    PAIR,
    Array,
    Objective,
    Path,
    Uncovered,
    lengths_of,
    objectives_of,
    parse_path,
    parse_uncovered,
)


@dataclass(frozen=True, kw_only=True, eq=False)
class RobotRoute:
    """The route of one robot.

    Attributes:
        robot: Its id.
        tour: Its places in order, from its start to its end, shape (k,).
        lengths: Its lengths, shape (2,).
        path: Its path over the map, if the request asked for paths.
    """

    robot: str
    tour: NDArray[np.int64]
    lengths: Array
    path: Path | None


@dataclass(frozen=True, kw_only=True, eq=False)
class RobotPlan:
    """A plan of a front.

    Attributes:
        balance: 0 at the least first length of the front, 1 at the least second.
        lengths: Its lengths, shape (2,).
        routes: The routes of the robots used.
    """

    balance: float
    lengths: Array
    routes: tuple[RobotRoute, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class RobotFront:
    """The plans of a front, in order of their first length.

    Attributes:
        id: The id under which the service stores the front.
        status: The status of its job.
        plans: The m plans.
        lengths: Their lengths, shape (m, 2).
        places: The row and column of each place, shape (n, 2).
        points: The number of nondominated plans found; the front is a subset of these.
        hypervolume: The share of the box at the reference point that the plans dominate.
        reference_point: The reference point, shape (2,).
        objectives: Both objectives, as the service names them.
        terminated: Why the search ended; None while it runs.
        document: The whole answer, with every member.
        uncovered: The free cells of the map that no path leads to.
    """

    id: str
    status: str
    plans: tuple[RobotPlan, ...]
    lengths: Array
    places: NDArray[np.int64]
    points: int
    hypervolume: float
    reference_point: Array | None
    objectives: tuple[Objective, ...]
    terminated: str | None
    document: Mapping[str, Any]
    uncovered: Uncovered | None = None


def parse_robots(document: Mapping[str, Any]) -> RobotFront:
    """Return the front of plans for robots in a JSON answer.

    Raises:
        UnexpectedAnswer: A member is missing or wrong.
    """
    answer = members(document, "answer")
    places = indexes(None, PAIR)(answer.document.get("places") or [], "answer/places")
    return RobotFront(
        id=answer.read("id", text),
        status=answer.read("status", text),
        plans=answer.read("front", each(partial(_parse_plan, places=len(places)))),
        lengths=lengths_of(answer.read("front", each(members))),
        places=places,
        points=answer.read("points", count),
        hypervolume=answer.read("hypervolume", number),
        reference_point=answer.maybe("reference_point", floats(PAIR)),
        objectives=objectives_of(answer) or (),
        terminated=answer.maybe("terminated", text),
        document=document,
        uncovered=answer.maybe("uncovered", parse_uncovered),
    )


def _parse_plan(value: Any, where: str, places: int) -> RobotPlan:
    plan = members(value, where)
    return RobotPlan(
        balance=plan.read("balance", number),
        lengths=plan.read("lengths", floats(PAIR)),
        routes=plan.read("routes", each(partial(_parse_route, places=places))),
    )


def _parse_route(value: Any, where: str, places: int) -> RobotRoute:
    route = members(value, where)
    return RobotRoute(
        robot=route.read("robot", text),
        tour=route.read("tour", indexes(None, below=places)),
        lengths=route.read("lengths", floats(PAIR)),
        path=route.maybe("path", parse_path),
    )
