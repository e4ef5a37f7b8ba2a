"""Tasks: what is planned, as a request says it once it is checked."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from service.construction.repairs import TOURS_REPAIRED
from service.coverage.coverage import Coverage
from service.errors import CityNames
from service.front import PlanOptions
from service.replanning.earlier_tours import EarlierTours
from service.requests.fleets.subject import UnmeasuredFleet
from service.requests.maps.robots import SharedCoverage
from service.requests.schemas import Geometry
from service.requests.stops import Labels, Stops

KindName = Literal["front", "coverage", "fleet", "robots"]
_BRIEF = 5000  # preferences times cities
_KINDS: Mapping[type, KindName] = {
    Stops: "front",
    Coverage: "coverage",
    UnmeasuredFleet: "fleet",
    SharedCoverage: "robots",
}


@dataclass(frozen=True, eq=False, kw_only=True)
class Task:
    """A front to plan, checked and ready for the planner.

    Args:
        subject: What tours go through: stops; the places of a map, for one robot or several; or
            the stops of a fleet.
        options: The options for the planner.
        actor: The name of the actor that builds the first tours; empty for a fleet, or several
            robots, where none is loaded that reads matrices.
        paths: Whether each tour comes with its path over the map.
        arrivals: Whether each tour comes with both lengths up to each stop.
        geometry: What the lines of the answer follow, where that is GeoJSON.
        labels: The caller's names of stops and objectives.
        timings: Milliseconds of what was done for it since it was parsed, by name.
        earlier: What is left of the tours of the front that is replanned, if one is.
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

    @property
    def kind(self) -> KindName:
        """The kind of its front."""
        return _KINDS[type(self.subject)]

    @property
    def stops(self) -> Stops | None:
        """The stops, with the sources of the costs between them; None on a map."""
        match self.subject:
            case Stops() as stops:
                return stops
            case UnmeasuredFleet(stops=stops):
                return stops
        return None

    @property
    def city_names(self) -> CityNames:
        """The names of its cities in refusals; the request to replan has none of the rest."""
        names = CityNames()
        if self.labels is not None:
            names = self.labels.city_names
        elif isinstance(self.subject, Coverage):
            given = self.subject.places is not None
            names = CityNames("place", part="places" if given else None)
        return names if self.earlier is None else replace(names, part=None)

    @property
    def needs_compiled_code(self) -> bool:
        """Whether planning needs more than the network: search, bound, best subset, or a map."""
        if not isinstance(self.subject, Stops):
            return True
        options = self.options
        constructed = len(options.angles) * (TOURS_REPAIRED if options.repairs > 0 else 1)
        return options.time_limit > 0 or options.bound or constructed > options.size

    @property
    def is_brief(self) -> bool:
        """Whether planning is one short call of a network: by pa-one, of 50 ms or less."""
        if not isinstance(self.subject, Stops) or self.needs_compiled_code:
            return False
        short = len(self.options.angles) * self.subject.n <= _BRIEF
        return short and self.options.repairs == 0 and self.subject.measured


TaskKind = Literal["front", "coverage", "fleet", "task", "replan", "replan-coverage"]


@dataclass(frozen=True)
class TaskSource:
    """The bytes from which a task is read: a request as it came, or a task as it is stored.

    Args:
        kind: The kind of request, named after its path; or `task`, as `encode_task` writes it.
            Earlier versions stored requests: those to replan as `replan` or `replan-coverage`.
        body: The request as JSON, or the task.
        upload: The .npy file of matrices, or the PNG or PGM file of a map, where one came with it.
    """

    kind: TaskKind
    body: bytes
    upload: bytes | None = None

    @property
    def length(self) -> int:
        """The number of bytes."""
        return len(self.body) + len(self.upload or b"")
