"""Check that what each stop and each type of vehicles asks for fits the rest of a fleet's rules."""

from collections.abc import Container, Mapping, Sequence
from math import inf
from typing import NamedTuple

from service.errors import invalid
from service.fleet.rounding import is_over
from service.fleet.vehicles import ALWAYS, Shipment, Span, VehicleType, Visit


class Basis(NamedTuple):
    """What stops and vehicles must fit.

    Attributes:
        timed: Whether there is a clock.
        summed: Whether the first objective is a sum.
        limited: Whether the lengths of routes can be bounded.
        far: Whether there are costs that are not time.
        ships: Whether there are shipments.
        takes: Whether there are stops with a pick-up of their own.
        dimensions: The number of dimensions of demands and capacities.
    """

    timed: bool
    summed: bool
    limited: bool
    far: bool
    ships: bool
    takes: bool
    dimensions: int


def check_vehicle(vehicle: VehicleType, part: str, basis: Basis) -> None:
    """Raise a refusal if a type of vehicles contradicts itself or the other rules."""
    if len(vehicle.capacity) != basis.dimensions:
        values = {"numbers": basis.dimensions, "other": "/vehicles/0"}
        raise invalid(f"{part}/capacity", "not-as-first", **values, came=len(vehicle.capacity))
    _check_span(vehicle.shift, f"{part}/shift", basis)
    if vehicle.max_overtime and vehicle.shift[1] == inf:
        raise invalid(f"{part}/max_overtime", "endless-shift")
    _check_initial_load(vehicle, part, basis)
    _check_trips(vehicle, part, basis)
    _check_breaks(vehicle, part, basis)
    _check_prices(vehicle, part, basis)
    _check_limits(vehicle, part, basis)
    if vehicle.shortest > vehicle.longest:
        raise invalid(f"{part}/shortest", "over-longest", limit=vehicle.longest)
    if vehicle.max_stops is not None and vehicle.min_stops > vehicle.max_stops:
        raise invalid(f"{part}/min_stops", "over-max-stops", limit=vehicle.max_stops)


def _check_limits(vehicle: VehicleType, part: str, basis: Basis) -> None:
    """Raise a refusal of bounds of routes where there is nothing that they are of."""
    for name, given in (("longest", vehicle.longest != inf), ("shortest", vehicle.shortest > 0)):
        if not basis.limited and given:
            raise invalid(f"{part}/{name}", "unlimited")
    if vehicle.max_driving < inf and not basis.timed:
        raise invalid(f"{part}/max_driving", "untimed")
    if vehicle.max_distance < inf and not basis.far:
        raise invalid(f"{part}/max_distance", "only-times")


def _check_prices(vehicle: VehicleType, part: str, basis: Basis) -> None:
    """Raise a refusal of prices and factors that count in nothing."""
    prices = {
        "fixed": vehicle.fixed > 0,
        "per_distance": vehicle.per_distance != 1,
        "per_time": vehicle.per_time > 0,
    }
    for name, given in prices.items():
        if given and not basis.summed:
            raise invalid(f"{part}/{name}", "unsummed")
    timed = {
        "per_time": vehicle.per_time > 0,
        "speed_factor": vehicle.speed_factor != 1,
        "service_factor": vehicle.service_factor != 1,
    }
    for name, given in timed.items():
        if given and not basis.timed:
            raise invalid(f"{part}/{name}", "untimed")


def _check_initial_load(vehicle: VehicleType, part: str, basis: Basis) -> None:
    load = vehicle.initial_load
    if load and len(load) != basis.dimensions:
        numbers, came = basis.dimensions, len(load)
        raise invalid(f"{part}/initial_load", "not-as-capacity", numbers=numbers, came=came)
    for dimension, (loaded, most) in enumerate(zip(load, vehicle.capacity, strict=False)):
        if loaded > most:
            where = f"{part}/initial_load/{dimension}"
            raise invalid(where, "over-capacity", limit=most, came=loaded)


def _check_breaks(vehicle: VehicleType, part: str, basis: Basis) -> None:
    free = 0.0
    for index, (opens, closes, length) in enumerate(vehicle.breaks):
        where = f"{part}/breaks/{index}/window"
        if not basis.timed:
            raise invalid(where, "untimed")
        if closes < opens or is_over(free, opens):
            raise invalid(where, "break-not-after", begin=opens, end=closes)
        free = closes + length


def _check_trips(vehicle: VehicleType, part: str, basis: Basis) -> None:
    if vehicle.max_trips is not None and not vehicle.reload:
        raise invalid(f"{part}/max_trips", "no-reload")
    if vehicle.reload and vehicle.max_stops is not None:
        raise invalid(f"{part}/max_stops", "also-given", member="reload")
    if basis.takes and vehicle.reload:
        raise invalid(f"{part}/reload", "also-given", member="pickup of stops")
    if basis.ships:
        for name, given in (("reload", vehicle.reload), ("max_stops", vehicle.max_stops)):
            if given:
                raise invalid(f"{part}/{name}", "also-given", member="shipments")


def check_visit(visit: Visit, part: str, basis: Basis) -> None:
    """Raise a refusal if a stop contradicts itself or the other rules."""
    for name, timed in (
        ("service", visit.service),
        ("services", visit.services),
        ("due", visit.due < inf or visit.wanted > 0),
        ("release", visit.release),
    ):
        if timed and not basis.timed:
            raise invalid(f"{part}/{name}", "untimed")
    if visit.wanted > visit.due:
        raise invalid(f"{part}/due", "ends-early", begin=visit.wanted, end=visit.due)
    for number, window in enumerate(visit.windows):
        alone = len(visit.windows) == 1
        _check_span(window, f"{part}/window" if alone else f"{part}/windows/{number}", basis)
    check_loads({"demand": visit.demand, "pickup": visit.pickup}, part, basis.dimensions)
    if visit.prize is not None and not basis.summed:
        raise invalid(f"{part}/prize", "unsummed")


def check_loads(loads: Mapping[str, Sequence[int]], part: str, dimensions: int) -> None:
    """Raise a refusal unless the loads of a stop, by the members that have them, fit capacities."""
    for name, load in loads.items():
        if load and len(load) != dimensions:
            came = len(load)
            raise invalid(f"{part}/{name}", "not-as-capacities", numbers=dimensions, came=came)


def check_depot(visit: Visit, part: str) -> None:
    """Raise a refusal if a depot asks for what only other stops can."""
    members = (
        ("window", visit.windows != (ALWAYS,)),
        ("demand", any(visit.demand)),
        ("pickup", any(visit.pickup)),
        ("service", visit.service),
        ("services", visit.services),
        ("prize", visit.prize is not None),
        ("due", visit.due < inf or visit.wanted > 0),
        ("release", visit.release),
        ("urgency", visit.urgency != 1),
        ("skills", visit.skills),
        ("vehicle", visit.vehicles),
    )
    given = [name for name, is_given in members if is_given]
    if not given:
        return
    first, *others = given
    if first == "window":
        code = "window-and-more-of-depot" if others else "window-of-depot"
    else:
        code = "several-of-depot" if others else "of-depot"
    raise invalid(f"{part}/{first}", code, members=" or ".join(others) or None)


def _check_span(span: Span, part: str, basis: Basis) -> None:
    if span[0] > span[1]:
        raise invalid(part, "ends-early", begin=span[0], end=span[1])
    if not basis.timed and span != ALWAYS:
        raise invalid(part, "untimed")


def check_shipped(visit: Visit, stop: int) -> None:
    """Raise a refusal where a stop of a shipment asks for what only other stops can."""
    if len(visit.windows) > 1:
        raise invalid(f"stops/{stop}/windows", "windows-of-shipment")
    if visit.release:
        raise invalid(f"stops/{stop}/release", "release-of-shipment")
    if any(visit.pickup):
        raise invalid(f"stops/{stop}/pickup", "pickup-of-shipment")


def check_shipments(
    shipments: Sequence[Shipment], visits: Sequence[Visit], depots: Container[int]
) -> None:
    """Raise a refusal if a stop is in two shipments, or asks for what it cannot in one."""
    parts: dict[int, str] = {}
    for index, shipment in enumerate(shipments):
        for name, stop in (("pickup", shipment.pickup), ("delivery", shipment.delivery)):
            part = f"shipments/{index}/{name}"
            if stop in depots:
                raise invalid(part, "shipped-to-depot")
            if parts.setdefault(stop, part) != part:
                raise invalid(part, "in-two-shipments", other=f"/{parts[stop]}")
            check_shipped(visits[stop], stop)
        delivery = visits[shipment.delivery]
        if any(delivery.demand) or delivery.prize is not None:
            raise invalid(f"shipments/{index}/delivery", "delivery-asks")


def check_percents(
    percents: Sequence[int | None],
    of_clock: Sequence[bool],
    vehicles: Sequence[VehicleType],
    *,
    spreads: bool,
) -> None:
    """Raise a refusal of a percentile of what does not spread, or is not just the time of routes.

    Args:
        percents: Of each objective; None for no percentile.
        of_clock: Whether each objective is the time of routes.
    """
    for index, percent in enumerate(percents):
        part = f"objectives/{index}/percentile"
        if percent is None:
            continue
        if not of_clock[index]:
            raise invalid(part, "spread-of-clock")
        if not spreads:
            raise invalid(part, "no-spread")
        for number, vehicle in enumerate(vehicles):
            _check_beside_percentile(vehicle, f"vehicles/{number}", f"/{part}", first=index == 0)


def _check_beside_percentile(vehicle: VehicleType, part: str, other: str, *, first: bool) -> None:
    """Raise a refusal of breaks, and of prices of the first objective if that has a percentile."""
    for name, given in (
        ("breaks", bool(vehicle.breaks)),
        ("per_distance", first and vehicle.per_distance != 1),
        ("per_time", first and vehicle.per_time > 0),
    ):
        if given:
            raise invalid(f"{part}/{name}", "beside-a-percentile", other=other)
