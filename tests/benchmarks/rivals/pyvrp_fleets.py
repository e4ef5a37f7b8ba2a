"""PyVRP alone, for fleets of one type of vehicle."""

import warnings

import pyvrp
from pyvrp.exceptions import PenaltyBoundWarning
from pyvrp.stop import MaxRuntime

from service.fleet.evaluation import violations
from service.fleet.fleet import Fleet
from service.fleet.goal import Goal
from service.fleet.plans import Plan
from service.fleet.translation import Translation


def route_by_pyvrp(fleet: Fleet, vehicle_cost: float, seconds: float) -> Plan | None:
    """The plan of the least distance and cost of vehicles; None if none was found."""
    translation = Translation(fleet)
    data = translation.data(Goal(weights=translation.sum_weights))
    (kind,) = data.vehicle_types()
    fixed = round(vehicle_cost * translation.scales[0])
    data = data.replace(vehicle_types=[kind.replace(fixed_cost=fixed)])
    with warnings.catch_warnings(action="ignore", category=PenaltyBoundWarning):
        result = pyvrp.solve(data, MaxRuntime(seconds), collect_stats=False, display=False)
    plan = translation.plan(result.best)
    return None if violations(fleet, plan) else plan
