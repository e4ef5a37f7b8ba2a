"""Print fronts of plans: as CSV, a line for each route, and as a table, a row for each plan."""

from collections.abc import Sequence

from paretour import FleetFront, FleetPlan, FleetRoute, RobotFront, RobotPlan, RobotRoute
from rich.markup import escape
from rich.table import Table

from service.cli.data import csv_text
from service.cli.labels import labels_of

FrontOfPlans = FleetFront | RobotFront


def plans_as_rows(front: FrontOfPlans) -> list[tuple[object, ...]]:
    """Return a row for each route: its plan, the plan's lengths, who goes it, and its stops."""
    names = [each.name for each in front.objectives]
    who, where = ("robot", "places") if isinstance(front, RobotFront) else ("vehicle", "stops")
    rows: list[tuple[object, ...]] = [
        ("plan", "balance", *names, who, *(f"route {name}" for name in names), where)
    ]
    for number, plan in enumerate(_plans(front)):
        for route in plan.routes:
            mover, stops = _members(route)
            lengths = (*plan.lengths.tolist(), mover, *route.lengths.tolist())
            rows.append((number, plan.balance, *lengths, stops))
    return rows


def _plans(front: FrontOfPlans) -> Sequence[FleetPlan | RobotPlan]:
    return front.plans


def _members(route: FleetRoute | RobotRoute) -> tuple[str, str]:
    """Return who goes a route, and its stops with spaces between."""
    if isinstance(route, RobotRoute):
        return route.robot, " ".join(map(str, route.tour))
    return route.vehicle, csv_text([route.stops], delimiter=" ")


def plans_as_table(front: FrontOfPlans) -> Table:
    """Return a table with a row for each plan."""
    counts = ("robots",) if isinstance(front, RobotFront) else ("vehicles", "left out")
    table = Table("plan", "balance", *map(escape, labels_of(front)), *counts)
    for column in table.columns:
        column.justify = "right"
    for number, plan in enumerate(_plans(front)):
        lengths = (f"{length:.6g}" for length in plan.lengths)
        left_out = () if isinstance(plan, RobotPlan) else (str(len(plan.unassigned)),)
        routes = str(len(plan.routes))
        table.add_row(str(number), f"{plan.balance:.3f}", *lengths, routes, *left_out)
    return table
