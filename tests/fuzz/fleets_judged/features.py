"""The features of fleets, by what a request must have to use them: each is tried as often."""

from collections.abc import Callable, Mapping
from typing import Any

from tests.fuzz.fleets_judged.day import is_over_the_day
from tests.fuzz.fleets_judged.timeline import Json

_COSTS = ("over_the_day", "slices", "breakpoints", "spread", "days", "percentile")


def features_of(request: Json) -> set[str]:
    """Return the names of the features that a request uses."""
    return {name for name, uses in FEATURES.items() if uses(request)}


def _items(request: Json) -> list[Json]:
    """Return all that costs are read from."""
    items = [each for each in (*request["objectives"], request.get("clock")) if each]
    named = [each for each in items if isinstance(each, dict)]
    return [*named, *(own for each in named for own in each.get("matrices", ()))]


def _of_costs(name: str) -> Callable[[Json], bool]:
    return lambda request: any(name in each for each in _items(request))


def _of_vehicles(name: str) -> Callable[[Json], bool]:
    return lambda request: any(name in each for each in request["vehicles"])


def _of_stops(name: str) -> Callable[[Json], bool]:
    return lambda request: any(name in each for each in request["stops"])


def _of_day(uses: Callable[[Json], bool]) -> Callable[[Json], bool]:
    return lambda request: is_over_the_day(request) and uses(request)


def _of_objectives(name: str, value: Any) -> Callable[[Json], bool]:
    return lambda request: any(each.get(name) == value for each in request["objectives"])


def _waits(request: Json) -> bool:
    return any(each.get("vehicles") == "any" for each in request.get("before", ()))


def _orders(request: Json) -> bool:
    return any("vehicles" not in each for each in request.get("before", ()))


_VEHICLES = (
    *("speed_factor", "service_factor", "per_distance", "per_time", "fixed", "profile"),
    *("max_distance", "max_driving", "min_stops", "max_stops", "shortest", "longest"),
    *("breaks", "shifts", "max_overtime", "reload", "initial_load"),
)
_STOPS = ("services", "pickup", "windows", "release", "skills", "vehicle", "prize")
_MEASURES = (
    *("overlap", "weighted_arrival", "earliness", "lateness", "overtime", "vehicles"),
    *("unassigned", "imbalance", "load_distance", "changes", "on_time"),
)
FEATURES: Mapping[str, Callable[[Json], bool]] = {
    **{name: _of_costs(name) for name in _COSTS},
    **{name: _of_vehicles(name) for name in _VEHICLES},
    **{name: _of_stops(name) for name in _STOPS},
    **{f"measure {name}": _of_objectives("measure", name) for name in _MEASURES},
    **{f"{name} over the day": _of_day(_of_vehicles(name)) for name in ("breaks", "shifts")},
    "windows over the day": _of_day(_of_stops("windows")),
    "before": _orders,
    "before over vehicles": _waits,
    "together": lambda request: "together" in request,
    "apart": lambda request: "apart" in request,
    "shipments": lambda request: bool(request["shipments"]),
    "three objectives": lambda request: len(request["objectives"]) > 2,
}
