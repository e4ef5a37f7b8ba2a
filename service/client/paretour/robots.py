"""Fronts of plans for several robots on a map, as immutable values."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from paretour.values import (
    Array,
    Objective,
    Path,
    Status,
    Uncovered,
    objectives_of,
    parse_path,
    parse_uncovered,
    read_only_floats,
    read_only_integers,
)


@dataclass(frozen=True, kw_only=True, eq=False)
class RobotRoute:
    """The route of one robot.

    Attributes:
        robot: Its id.
        tour: Its places in order, from its start to its end, shape (k,).
        lengths: Its lengths, shape (2,).
        path: Its way over the map, where the request asked for paths.
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
        routes: Of the robots that leave.
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
        points: The number of nondominated plans found, of which these are returned.
        hypervolume: The share of the box at the reference point that the plans dominate.
        objectives: Both objectives, as the service names them.
        terminated: Why the search ended; None while it runs.
        document: The answer as it came, with every member.
        uncovered: The free cells of the map that no path leads to.
    """

    id: str
    status: Status
    plans: tuple[RobotPlan, ...]
    lengths: Array
    places: NDArray[np.int64]
    points: int
    hypervolume: float
    objectives: tuple[Objective, ...]
    terminated: Literal["converged", "time_limit", "cancelled"] | None
    document: Mapping[str, Any]
    uncovered: Uncovered | None = None


def parse_robots(document: Mapping[str, Any]) -> RobotFront:
    """Return the front of plans for robots in a JSON answer."""
    items = document["front"]
    return RobotFront(
        id=document["id"],
        status=document["status"],
        plans=tuple(_parse_plan(item) for item in items),
        lengths=read_only_floats([item["lengths"] for item in items]).reshape(-1, 2),
        places=read_only_integers(document["places"]).reshape(-1, 2),
        points=document["points"],
        hypervolume=document["hypervolume"],
        objectives=objectives_of(document) or (),
        terminated=document["terminated"],
        document=document,
        uncovered=parse_uncovered(document),
    )


def _parse_plan(item: Mapping[str, Any]) -> RobotPlan:
    return RobotPlan(
        balance=item["balance"],
        lengths=read_only_floats(item["lengths"]),
        routes=tuple(_parse_route(route) for route in item["routes"]),
    )


def _parse_route(route: Mapping[str, Any]) -> RobotRoute:
    return RobotRoute(
        robot=route["robot"],
        tour=read_only_integers(route["tour"]),
        lengths=read_only_floats(route["lengths"]),
        path=parse_path(route),
    )
