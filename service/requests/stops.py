"""Stops and objectives as a request names them, and the instance made from their costs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from service.day.breakpoints import Breakpoints
from service.day.costs import CostsOfDay
from service.errors import CityNames
from service.instance import CLOSED, Instance, Kind, RouteEnds
from service.objectives import Objective
from service.over_the_day.day import Day
from service.reliability.spread import Spread
from service.roads.great_circle import great_circle_matrix

Array = NDArray[np.float64]
Location = tuple[float, float]  # longitude and latitude in degrees, WGS84
Measure = Literal["great_circle", "road_time", "road_distance"]
UNITS: Mapping[Measure, str] = {"great_circle": "m", "road_time": "s", "road_distance": "m"}
KMH = 3.6  # km/h that are one metre per second
ROAD_MEASURES: tuple[Measure, ...] = ("road_time", "road_distance")


@dataclass(frozen=True)
class Stop:
    """A stop, with the caller's id for it, and where it is on the earth if the caller said so."""

    id: str
    location: Location | None = None


@dataclass(frozen=True)
class Labels:
    """The caller's names of everything in a request: its n stops, in order, and its objectives.

    Args:
        parts: Of a request to replan: the part that has each stop, as add/0; empty for those of the
            earlier front. None where the request lists all stops.
    """

    stops: tuple[Stop, ...]
    objectives: tuple[Objective, ...]
    parts: tuple[str, ...] | None = None

    @property
    def id_bytes(self) -> int:
        """The bytes of all ids in one tour of an answer."""
        return len(to_json([stop.id for stop in self.stops]))

    @property
    def city_names(self) -> CityNames:
        """The names of the stops in refusals."""
        return CityNames("stop", [stop.id for stop in self.stops], "stops", self.parts)

    @property
    def members(self) -> dict[str, Any]:
        """All names, ready for JSON: `asdict` takes ten times as long."""
        return {
            "stops": [dict(vars(stop)) for stop in self.stops],
            "objectives": [dict(vars(objective)) for objective in self.objectives],
        }


@dataclass(frozen=True, eq=False)
class Matrix:
    """A source of costs: a matrix of them, shape (n, n)."""

    costs: Array


@dataclass(frozen=True, eq=False)
class Plane:
    """A source of costs: the distances between points of a plane, shape (n, 2)."""

    points: Array


@dataclass(frozen=True)
class Measured:
    """A source of costs: a measure of the way between the locations of stops.

    Args:
        speed: The km/h at which metres along great circles become seconds; None leaves metres.
        profile: Of vehicles, by road; None for what the operator has set.
    """

    measure: Measure
    speed: float | None = None
    profile: str | None = None


@dataclass(frozen=True, eq=False)
class Changed:
    """A source of costs: another source, with changed costs of some steps.

    Args:
        steps: Where each step begins and ends, shape (m, 2).
        costs: The cost of each step, shape (m,).
    """

    base: Plane | Measured
    steps: NDArray[np.int64]
    costs: Array


FixedSource = Matrix | Plane | Measured | Changed


@dataclass(frozen=True, eq=False)
class OverTheDay:
    """A source of costs: those of another source, times a factor that changes over the day.

    Args:
        begins: The times from which each factor holds, shape (s,), ascending seconds of the day.
        factors: Shape (s,), positive.
    """

    base: FixedSource
    begins: Array
    factors: Array


@dataclass(frozen=True, eq=False)
class Slices:
    """A source of costs: a matrix of them in each slice of the day.

    Args:
        begins: When each slice begins, shape (s,), ascending seconds of the day.
        costs: Shape (s, n, n).
    """

    begins: Array
    costs: Array


@dataclass(frozen=True)
class Traffic:
    """A source of costs: the seconds by road in each slice of a day, as a routing engine knows it.

    Args:
        day: The date.
        begins: When each slice begins, ascending seconds of the day that are whole minutes.
        profile: As in `Measured`.
    """

    day: str
    begins: tuple[float, ...]
    profile: str | None = None

    @property
    def departures(self) -> list[str]:
        """The local time at which each slice begins, such as 2026-11-27T07:30."""
        midnight = datetime.fromisoformat(self.day)
        each = [midnight + timedelta(seconds=seconds) for seconds in self.begins]
        return [time.isoformat(timespec="minutes") for time in each]


Source = FixedSource | OverTheDay | Slices | Breakpoints | Traffic


@dataclass(frozen=True, eq=False)
class Hours:
    """The times at which tours may begin, and those that visits take, if costs change over the day.

    Args:
        clock: The index of the objective whose costs are seconds of travel.
        service: The seconds of a visit to each stop, shape (n,).
        earliest: The first second of the day at which a tour may begin.
        latest: The last one.
    """

    clock: int
    service: Array
    earliest: float
    latest: float


@dataclass(frozen=True, eq=False)
class Stops:
    """Stops, where the costs between them come from, and the ends of tours.

    Args:
        locations: Longitude and latitude of each stop in degrees, shape (n, 2); NaN where a stop
            has none, which no measure allows.
        sources: The source of the costs of each objective.
        ends: Whether tours are closed, and the fixed ends of open routes.
        hours: When tours begin, if their costs depend on that.
        spreads: How the costs of each objective spread; empty if none do.
    """

    locations: Array
    sources: Sequence[Source]
    ends: RouteEnds = CLOSED
    hours: Hours | None = None
    spreads: tuple[Spread | None, ...] = ()

    @property
    def n(self) -> int:
        """The number of stops."""
        return len(self.locations)

    @property
    def stops(self) -> "Stops":
        """The stops themselves, as fleets have stops too."""
        return self

    @property
    def city_names(self) -> CityNames:
        """The names of its stops in refusals, if they have no others."""
        return CityNames()

    @property
    def kind(self) -> Kind:
        """The kind of instance that they become."""
        return "matrices" if self.hours or self.spreads else kind_of(self.sources)

    @property
    def changes(self) -> bool:
        """Whether some costs change over the day."""
        return not all(isinstance(source, FixedSource) for source in self.sources)

    @property
    def measured(self) -> bool:
        """Whether no costs are left to be measured."""
        unmeasured = Measured | Traffic
        return not any(isinstance(base_of(source), unmeasured) for source in self.sources)

    @cached_property
    def instance(self) -> Instance:
        """The stops and the costs between them as an instance. O(n^2) unless all are planes.

        Where costs change over the day, these are the mean ones.

        Raises:
            InvalidInstance: The costs are too large, or too far apart, to be planned.
        """
        if self.day is not None:
            return self.day.instance
        ends = self.ends._asdict()
        planes = [source.points for source in self.sources if isinstance(source, Plane)]
        if len(planes) == len(self.sources) and not self.spreads:
            return Instance(coordinates=np.concatenate(planes, axis=1), **ends)
        return Instance(matrices=cost_matrices(self), **ends)

    @cached_property
    def day(self) -> Day | None:
        """The costs over the day, all of them measured; None if they do not depend on the time."""
        if self.hours is None:
            return None
        return Day(costs=costs_of_day(self), ends=self.ends, **vars(self.hours))

    @cached_property
    def known_scale(self) -> tuple[Array, Array] | None:
        """The scale and the default reference point, shape (m,); None before all is measured."""
        return (self.instance.scale, self.instance.reference_point) if self.measured else None

    def __getstate__(self) -> dict[str, Any]:
        """Leave out the instance: another process makes it from the sources as fast as it reads it.

        The scale goes with the stops, once it is known.
        """
        return {k: value for k, value in vars(self).items() if k not in ("instance", "day")}

    @property
    def road_profiles(self) -> list[str | None]:
        """The profiles of vehicles that a routing engine has to be asked for."""
        bases = [base_of(source) for source in self.sources]
        by_road = (source for source in bases if isinstance(source, Measured))
        return list(dict.fromkeys(s.profile for s in by_road if s.measure in ROAD_MEASURES))

    @property
    def traffic(self) -> frozenset[Traffic]:
        """The traffic that a routing engine has to be asked for."""
        return frozenset(source for source in self.sources if isinstance(source, Traffic))

    def measured_by_road(self, costs: Mapping[Measured | Traffic, Array]) -> "Stops":
        """Return these stops with what was measured in place of each measure by road.

        Args:
            costs: A matrix for each measure, shape (n, n), and for traffic one in each of its s
                slices, shape (s, n, n).
        """
        known: dict[Measured, Matrix] = {}

        def measured(source: FixedSource) -> FixedSource:
            match source:
                case Measured("road_time" | "road_distance"):
                    return known.setdefault(source, Matrix(costs[source]))
                case Changed(Measured("road_time" | "road_distance") as base):
                    return Matrix(changed_costs(costs[base], source.steps, source.costs))
            return source

        return replace(
            self,
            sources=[
                Slices(np.array(each.begins), costs[each])
                if isinstance(each, Traffic)
                else with_base(each, measured)
                for each in self.sources
            ],
        )


def kind_of(sources: Sequence[Source]) -> Kind:
    """Return the kind of instance that stops with these sources of costs become."""
    in_planes = all(isinstance(source, Plane) for source in sources)
    return "coordinates" if in_planes else "matrices"


def with_base(source: Source, change: Callable[[FixedSource], FixedSource]) -> Source:
    """Return a source that is changed; of one that changes over the day, what the factors are of.

    Slices, breakpoints and traffic stay as they are.
    """
    match source:
        case OverTheDay(base):
            return replace(source, base=change(base))
        case Slices() | Breakpoints() | Traffic():
            return source
    return change(source)


def base_of(source: Source) -> Source:
    """Return the source before single costs were changed, and before it changes over the day."""
    while isinstance(source, Changed | OverTheDay):
        source = source.base
    return source


def changed_costs(matrix: Array, steps: NDArray[np.int64], costs: Array) -> Array:
    """Return a copy of a matrix with the costs of some steps, shape (m, 2), set to these."""
    changed = matrix.copy()
    changed[steps[:, 0], steps[:, 1]] = costs
    return changed


def locations_of(stops: Sequence[Stop]) -> Array:
    """Return longitude and latitude of each stop, shape (n, 2); NaN where a stop has none."""
    return np.array([stop.location or (np.nan, np.nan) for stop in stops], dtype=np.float64)


def cost_matrices(stops: Stops) -> Array:
    """Return the costs between stops, all of them measured, shape (m, n, n)."""
    return np.stack([_costs(source, stops.locations) for source in stops.sources])


def costs_of_day(stops: Stops) -> list[CostsOfDay]:
    """Return the costs between stops over the day, all of them measured."""
    return [_over_the_day(source, stops.locations) for source in stops.sources]


def _over_the_day(source: Source, locations: Array) -> CostsOfDay:
    """Return the costs between all stops over the day."""
    match source:
        case OverTheDay(base, begins, factors):
            layers = np.zeros(len(begins), np.int64)
            return CostsOfDay(begins, factors, layers, _costs(base, locations)[np.newaxis])
        case Slices(begins, costs):
            return CostsOfDay(begins, np.ones(len(begins)), np.arange(len(begins)), costs)
        case Breakpoints():
            return CostsOfDay.by_pair(source)
    return CostsOfDay.constant(_costs(source, locations))


def _costs(source: Source, locations: Array) -> Array:
    """Return the costs between all stops, shape (n, n)."""
    match source:
        case Matrix(costs):
            return costs
        case Plane(points):
            steps = points[:, np.newaxis] - points
            return np.hypot(steps[..., 0], steps[..., 1])
        case Measured("great_circle", speed):
            metres = great_circle_matrix(locations)
            return metres if speed is None else metres / (speed / KMH)
        case Changed(base):
            return changed_costs(_costs(base, locations), source.steps, source.costs)
        case Measured(measure):
            raise ValueError(f"{measure} must be measured before, by a routing engine")
        case OverTheDay() | Slices() | Breakpoints() | Traffic():
            raise ValueError("costs that change over the day are not one matrix")
