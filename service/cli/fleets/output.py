"""Print fronts of plans: as CSV, a line for each route, and as a table, a row for each plan."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from paretour import FleetFront, FleetPlan, RobotFront, RobotPlan
from rich.markup import escape
from rich.table import Table

from service.cli.data import csv_text
from service.cli.labels import labels_of

FrontOfPlans = FleetFront | RobotFront


@dataclass(frozen=True, kw_only=True)
class Movers:
    """The movers on the routes of a plan: vehicles, or robots.

    Args:
        heading: The heading of the column with the mover of a route.
        visited: The heading of the column with what a route visits, in order.
        mover: Returns the mover of a route.
        visits: Returns the visits of a route, in order.
        counts: Functions that return a number of a plan, by the headings of further columns.
    """

    heading: str
    visited: str
    mover: Callable[[Any], str]
    visits: Callable[[Any], Sequence[object]]
    counts: dict[str, Callable[[Any], int]]


VEHICLES = Movers(
    heading="vehicle",
    visited="stops",
    mover=lambda route: route.vehicle,
    visits=lambda route: route.stops,
    counts={
        "vehicles": lambda plan: len(plan.routes),
        "left out": lambda plan: len(plan.unassigned),
    },
)
ROBOTS = Movers(
    heading="robot",
    visited="places",
    mover=lambda route: route.robot,
    visits=lambda route: route.tour.tolist(),
    counts={"robots": lambda plan: len(plan.routes)},
)


def plans_as_rows(front: FrontOfPlans, movers: Movers) -> list[tuple[object, ...]]:
    """Return a row for each route: plan, lengths of the plan, vehicle or robot, stops."""
    names = [each.name for each in front.objectives]
    of_routes = [f"route {name}" for name in names]
    rows: list[tuple[object, ...]] = [
        ("plan", "balance", *names, movers.heading, *of_routes, movers.visited)
    ]
    for number, plan in enumerate(_plans(front)):
        for route in plan.routes:
            lengths = (*plan.lengths.tolist(), movers.mover(route), *route.lengths.tolist())
            visits = csv_text([movers.visits(route)], delimiter=" ")
            rows.append((number, plan.balance, *lengths, visits))
    return rows


def plans_as_table(front: FrontOfPlans, movers: Movers) -> Table:
    """Return a table with a row for each plan."""
    table = Table("plan", "balance", *map(escape, labels_of(front)), *movers.counts)
    for column in table.columns:
        column.justify = "right"
    for number, plan in enumerate(_plans(front)):
        lengths = (f"{length:.6g}" for length in plan.lengths)
        counts = (str(count(plan)) for count in movers.counts.values())
        table.add_row(str(number), f"{plan.balance:.3f}", *lengths, *counts)
    return table


def _plans(front: FrontOfPlans) -> Sequence[FleetPlan | RobotPlan]:
    return front.plans
