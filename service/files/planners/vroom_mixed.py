"""Objectives and prices of VROOM's vehicles that differ in what they cost, or in their speed."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, cast

from service.files.fleets import Objective, Vehicle
from service.files.json_files.records import is_number
from service.files.planners.vroom_members import note_unused
from service.files.reading import Source

_PER_HOUR, _PER_KM = 3600, 0  # the defaults of VROOM
OF_COSTS = "costs of vehicles"
_HOURS = "per_hour of costs of vehicles is for the whole time of a route, with service and waiting."


class Ride(NamedTuple):
    """What an hour and a kilometre cost a vehicle, and how much faster than usual it is."""

    per_hour: float
    per_km: float
    speed: float


class Layers(NamedTuple):
    """The costs that are known of the legs between stops: objectives, of which one is time."""

    time: Objective
    distance: Objective | None = None
    cost: Objective | None = None


def nameless(**costs: Any) -> Objective:
    """Return costs as an objective that has no name yet."""
    return cast(Objective, costs)


def rides_of(source: Source, items: Sequence[Mapping[str, Any]]) -> list[Ride]:
    """Return what VROOM's vehicles cost, and how fast they are.

    Raises:
        UnreadableFile: A cost is not a number from 0.
    """
    rides = []
    for at, each in enumerate(items):
        costs, speed = each.get("costs") or {}, each.get("speed_factor", 1)
        if not isinstance(costs, dict):
            raise source.refusal("not-an-object", f"vehicles/{at}/costs", came=costs)
        for name in ("fixed", "per_hour", "per_km"):
            if not is_cost(costs.get(name, 0)):
                raise source.refusal("not-from-0", f"vehicles/{at}/costs/{name}", came=costs[name])
        if not is_cost(speed) or not speed:
            note_unused(source, "speed_factor", "vehicles", "it must be a number over 0")
            speed = 1
        rates = costs.get("per_hour", _PER_HOUR), costs.get("per_km", _PER_KM)
        rides.append(Ride(*rates, float(speed)))
    return rides


def mixed_objectives(
    source: Source, rides: Sequence[Ride], vehicles: Sequence[Vehicle], layers: Layers
) -> list[Objective]:
    """Return both objectives of vehicles that differ, whose prices become their members.

    The first is VROOM's cost. The second is the longest route, in time.
    """
    for ride, vehicle in zip(rides, vehicles, strict=True):
        if ride.speed != 1:
            vehicle["speed_factor"] = ride.speed
    if layers.cost is not None:
        note_rates(source, rides, "there are matrices of costs")
        first = layers.cost
    elif any(ride.per_km for ride in rides) and layers.distance is not None:
        first = _by_distance(source, rides, vehicles, layers.distance)
    else:
        first = _by_time(source, rides, vehicles, layers.time)
    return [{**first, "name": "cost", "over": "sum"}, {**layers.time, "over": "max"}]


def note_rates(source: Source, rides: Sequence[Ride], why: str) -> None:
    """Note what hours and kilometres cost, where that is not the default and is not used."""
    for name, usual in (("per_hour", _PER_HOUR), ("per_km", _PER_KM)):
        if any(getattr(ride, name) != usual for ride in rides):
            note_unused(source, name, OF_COSTS, why)


def _by_distance(
    source: Source, rides: Sequence[Ride], vehicles: Sequence[Vehicle], distance: Objective
) -> Objective:
    """Return distances, at the prices of kilometres and hours."""
    _set_prices(vehicles, [ride.per_km / 1000 for ride in rides])
    if any(ride.per_hour for ride in rides):
        source.note("objectives", _HOURS)
        for ride, vehicle in zip(rides, vehicles, strict=True):
            vehicle["per_time"] = _rounded(ride.per_hour / 3600)
    return distance


def _by_time(
    source: Source, rides: Sequence[Ride], vehicles: Sequence[Vehicle], time: Objective
) -> Objective:
    """Return travel times, at the prices of hours; the faster a vehicle, the less it pays."""
    if any(ride.per_km for ride in rides):
        note_unused(source, "per_km", OF_COSTS, "there are no matrices of distances")
    _set_prices(vehicles, [ride.per_hour / 3600 / ride.speed for ride in rides])
    return time


def _set_prices(vehicles: Sequence[Vehicle], prices: Sequence[float]) -> None:
    for vehicle, price in zip(vehicles, prices, strict=True):
        if price != 1:
            vehicle["per_distance"] = _rounded(price)


def _rounded(price: float) -> float:
    return round(price, 9)


def is_cost(value: Any) -> bool:
    """Return whether a value is a number from 0."""
    return is_number(value) and bool(value >= 0)
