"""Tasks: what a request asks for, checked and ready to be planned."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Literal

import numpy as np

from service.coverage.coverage import Coverage
from service.errors import CityNames, invalid
from service.fleet.fleet import LAYERS, Fleet
from service.fleet.measures.table import Measure
from service.fleet.plans import Route
from service.fleet.rules import Over, Rules
from service.fleet.vehicles import VehicleType
from service.front import PlanOptions
from service.objectives import Objective
from service.replanning.earlier_tours import EarlierTours
from service.requests.fields import Geometry
from service.requests.notes.note import Note
from service.requests.stops import (
    Array,
    Labels,
    Measured,
    Stops,
    Traffic,
    cost_matrices,
    costs_of_day,
)
from service.requests.straight_sources import are_straight, lines_of
from service.requests.validation import nearest

KindName = Literal["front", "coverage", "fleet", "robots"]
_MOST_STORED = 500  # stops; costs of more are worked out faster than read, where they are lines
_METRES = {"sum": "total distance", "max": "longest route"}
_SECONDS = {"sum": "total time", "max": "longest route"}
_COSTS = {"sum": "total cost", "max": "greatest cost"}


@dataclass(frozen=True)
class VehicleName:
    """The name of a type of vehicles in answers.

    Args:
        id: Its id.
        shift: The number of its shift, if those of its id have several.
        route: The number of its route in the plan that is driven, if it is on its way, or if
            changes of that plan count.
    """

    id: str
    shift: int | None = None
    route: int | None = None


def types_by_id(names: Sequence[VehicleName]) -> dict[str, tuple[int, ...]]:
    """Return the types of vehicles of each id: one for each of its shifts."""
    types: dict[str, tuple[int, ...]] = {}
    for index, name in enumerate(names):
        types[name.id] = (*types.get(name.id, ()), index)
    return types


def types_of(id: str, types: Mapping[str, tuple[int, ...]], part: str) -> tuple[int, ...]:
    """Return the types of vehicles of an id, which the member `vehicle` of a part has.

    Raises:
        Refusal: No vehicle has it.
    """
    if id not in types:
        raise invalid(f"{part}/vehicle", "not-a-vehicle", came=id, near=nearest(id, types))
    return types[id]


@dataclass(frozen=True, eq=False)
class UnmeasuredFleet:
    """The rules of a fleet, the names of its types of vehicles, and the sources of its costs.

    Args:
        vehicles: The name of each type of vehicles.
        stops: The stops, with the sources of two costs, by one profile of vehicles after another.
        driven: What is left of the routes of a plan that is being driven.
        clock: The name and unit of its times, if it has a clock.
        profiles: The names of these profiles; None for vehicles without one.
        spares: The types of vehicles of which none is left, though there may be more. Where visits
            name types, the first spare follows the last type of the rules.
        changes: The members of a request to replan that remedies change; None if it is none.
    """

    rules: Rules
    vehicles: tuple[VehicleName, ...]
    stops: Stops
    driven: tuple[Route, ...] = ()
    clock: Objective | None = None
    profiles: tuple[str | None, ...] = (None,)
    spares: tuple[VehicleType, ...] = ()
    names_of_spares: tuple[VehicleName, ...] = ()
    changes: Mapping[str, Any] | None = None

    @property
    def n(self) -> int:
        """The number of stops."""
        return self.rules.n

    @property
    def city_names(self) -> CityNames:
        """The names of its stops in refusals, if they have no others."""
        return self.stops.city_names

    @property
    def out_of_reach(self) -> list[int]:
        """The stops that must be visited by a type of vehicles of which none is left."""
        return [
            stop
            for stop, visit in enumerate(self.rules.visits)
            if stop in self.rules.required
            and visit.vehicles
            and min(visit.vehicles) >= len(self.rules.vehicles)
        ]

    def members(self, labels: Labels) -> dict[str, Any]:
        """Return the members of an answer that name stops, objectives and clock, ready for JSON."""
        members = labels.members
        objectives = zip(members["objectives"], self.rules.over, strict=True)
        named = [_objective(each, over) for each, over in objectives]
        clock = {} if self.clock is None else {"clock": dict(vars(self.clock))}
        return {**members, "objectives": named, **clock}

    def measured_by_road(self, costs: Mapping[Measured | Traffic, Array]) -> "UnmeasuredFleet":
        """Return this fleet with a matrix, shape (n, n), in place of each measure by road."""
        return replace(self, stops=self.stops.measured_by_road(costs))

    def fleet(self) -> Fleet:
        """Return the fleet with its costs. O(n^2), unless it is large and they are lines."""
        if self.n > _MOST_STORED and are_straight(self.stops.sources):
            return Fleet.of_lines(self.rules, lines_of(self.stops))
        if self.stops.changes:
            return Fleet.over_the_day(self.rules, *costs_of_day(self.stops))
        costs = cost_matrices(self.stops)
        sampled = next((each.days for each in self.stops.spreads if each), None)
        profiles = np.split(costs, len(costs) // LAYERS)
        return Fleet.of_profiles(self.rules, profiles, sampled=sampled)


def _objective(members: dict[str, Any], over: Over | Measure) -> dict[str, Any]:
    if over in ("sum", "max"):
        return {**members, "over": over}
    return {**members, "over": "sum", "measure": over}


@dataclass(frozen=True, eq=False)
class SharedCoverage:
    """A coverage task that robots share, and how a plan's lengths are made of their routes'."""

    coverage: Coverage
    over: tuple[Over, Over]
    stops: ClassVar[None] = None

    @property
    def city_names(self) -> CityNames:
        """The names of its places in refusals."""
        return self.coverage.city_names

    @property
    def members(self) -> dict[str, Any]:
        """The members of an answer about its objectives, and about open routes."""
        first, second = self.over
        closed = all(robot.closed for robot in self.coverage.robots)
        ways, unit = (_METRES, "m") if self.coverage.hours is None else (_SECONDS, "s")
        costs = {"name": _COSTS[second], "unit": None}
        longest = {"name": ways[second], "unit": unit}
        return {
            "closed": None if closed else False,
            "objectives": [
                {"name": ways[first], "unit": unit, "over": first},
                {**(costs if self.coverage.has_costs else longest), "over": second},
            ],
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class Task:
    """A front to plan, checked and ready for the planner.

    Args:
        subject: The stops that tours go through; the places of a map, for one robot or several; or
            the stops of a fleet.
        actor: The name of the actor that builds the first tours; empty for a fleet or several
            robots, if no actor that is loaded reads matrices.
        paths: Whether each tour comes with its path over the map.
        arrivals: Whether each tour comes with its lengths up to each stop.
        geometry: Whether lines in GeoJSON are straight or follow the streets.
        labels: The caller's names of stops and objectives.
        timings: Milliseconds of each step that was done for it after parsing, by name.
        earlier: What is left of the tours of the front that is replanned, if one is.
        parts: The part of the request that names each place, if a map is replanned; places/2 is
            place 2 of the earlier front.
        notes: What is likely to be a mistake, for answers.
    """

    subject: Stops | Coverage | SharedCoverage | UnmeasuredFleet
    options: PlanOptions
    actor: str
    paths: bool = False
    arrivals: bool = False
    geometry: Geometry = "straight"
    labels: Labels | None = None
    timings: Mapping[str, float] = field(default_factory=dict)
    earlier: EarlierTours | None = None
    parts: tuple[str, ...] = ()
    notes: tuple[Note, ...] = ()

    @property
    def stops(self) -> Stops | None:
        """The stops, with the sources of the costs between them; None on a map."""
        return self.subject.stops

    @property
    def is_over_the_day(self) -> bool:
        """Whether it is of tours whose lengths depend on when they begin."""
        subject = self.subject
        return isinstance(subject, Stops | Coverage) and subject.hours is not None

    @property
    def needs_roads(self) -> bool:
        """Whether it lacks costs by road."""
        return self.stops is not None and bool(self.stops.road_profiles or self.stops.traffic)

    @property
    def city_names(self) -> CityNames:
        """The names of its cities in refusals; a request to replan has no part that lists them."""
        names = self.subject.city_names if self.labels is None else self.labels.city_names
        return names if self.earlier is None else replace(names, part=None)


TaskKind = Literal["front", "coverage", "fleet", "replan"]


@dataclass(frozen=True)
class TaskSource:
    """A request as it came, from which a task is read.

    Args:
        kind: The kind of request, named after its path.
        body: The request as JSON.
        upload: The .npy file of matrices, or the PNG or PGM file of a map, where one came with it.
    """

    kind: TaskKind
    body: bytes
    upload: bytes | None = None

    @property
    def length(self) -> int:
        """The number of bytes."""
        return len(self.body) + len(self.upload or b"")
