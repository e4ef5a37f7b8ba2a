"""VROOM, for fleets of one type of vehicle."""

from datetime import timedelta

import numpy as np
import vroom

from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route
from service.fleet.vehicles import Span
from tests.benchmarks.rivals.twice import cheapest_twice

_FINE = 1000  # whole units of a cost of 1
_MOST = 2**31 - 1
_LEVEL = 5  # the greatest that it explores


def both_ends(fleet: Fleet, seconds: float) -> list[Plan]:
    """Return the plans for the least distance, and for the fewest vehicles, in `seconds` each."""
    return cheapest_twice(route_by_vroom, fleet, seconds)


def route_by_vroom(fleet: Fleet, vehicle_cost: float, seconds: float) -> Plan | None:
    """The plan of the least distance and cost of vehicles; None if it leaves out a stop.

    Of a fleet whose vehicles are of one type, and start and end at stop 0.
    """
    rules = fleet.rules
    (vehicle,) = rules.vehicles
    problem = vroom.Input()
    durations = np.ceil(_FINE * fleet.matrices()[0]).astype(np.uint32)
    problem.set_durations_matrix("car", durations)
    costs = vroom.VehicleCosts(fixed=round(_FINE * vehicle_cost))
    for number in range(min(vehicle.count, len(rules.clients))):
        problem.add_vehicle(
            vroom.Vehicle(
                number,
                start=0,
                end=0,
                capacity=list(vehicle.capacity),
                time_window=_window(vehicle.shift),
                costs=costs,
            )
        )
    for stop in rules.clients:
        if stop not in rules.shipped:
            visit = rules.visits[stop]
            problem.add_job(
                vroom.Job(
                    stop,
                    location=stop,
                    default_service=round(_FINE * visit.service),
                    delivery=list(visit.demand),
                    time_windows=[_window(visit.windows[0])],
                )
            )
    for each in rules.shipments:
        ends = (_step(fleet, stop) for stop in (each.pickup, each.delivery))
        amount = vroom.Amount(list(rules.visits[each.pickup].demand))
        problem.add_shipment(*ends, amount)
    solution = problem.solve(_LEVEL, 1, timedelta(seconds=seconds))
    if solution.summary.unassigned:
        return None
    steps = solution.routes
    visits = steps[steps["type"].isin(["job", "pickup", "delivery"])]
    routes = visits.groupby("vehicle_id")["id"].apply(lambda ids: tuple(map(int, ids)))
    return Plan(tuple(Route(0, stops) for stops in routes))


def _step(fleet: Fleet, stop: int) -> vroom.ShipmentStep:
    visit = fleet.rules.visits[stop]
    return vroom.ShipmentStep(
        stop,
        location=stop,
        default_service=round(_FINE * visit.service),
        time_windows=[_window(visit.windows[0])],
    )


def _window(span: Span) -> vroom.TimeWindow:
    begin, end = (round(min(_FINE * time, _MOST)) for time in span)
    return vroom.TimeWindow(begin, end)
