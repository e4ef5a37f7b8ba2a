"""Print fronts of plans: as CSV, a line for each route, and as a table, a row for each plan."""

import csv
import io

from paretour import FleetFront
from rich.markup import escape
from rich.table import Table


def fleet_as_csv(front: FleetFront) -> str:
    """Return a line for each route: its plan, the plan's lengths, and its own vehicle and stops."""
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    names = [each.name for each in front.objectives]
    lines.writerow(
        ("plan", "balance", *names, "vehicle", *(f"route {name}" for name in names), "stops")
    )
    for number, plan in enumerate(front.plans):
        for route in plan.routes:
            lengths = (*plan.lengths.tolist(), route.vehicle, *route.lengths.tolist())
            lines.writerow((number, plan.balance, *lengths, " ".join(route.stops)))
    return text.getvalue().rstrip()


def fleet_as_table(front: FleetFront) -> Table:
    """Return a table with a row for each plan."""
    headings = (
        each.name if each.unit is None else f"{each.name} ({each.unit})"
        for each in front.objectives
    )
    table = Table("plan", "balance", *map(escape, headings), "vehicles", "left out")
    for column in table.columns:
        column.justify = "right"
    for number, plan in enumerate(front.plans):
        lengths = (f"{length:.6g}" for length in plan.lengths)
        counts = (str(len(plan.routes)), str(len(plan.unassigned)))
        table.add_row(str(number), f"{plan.balance:.3f}", *lengths, *counts)
    return table
