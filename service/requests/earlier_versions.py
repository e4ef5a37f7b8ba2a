"""Read the replanning tasks that versions up to 0.1 stored. Delete this in the next release.

They stored a request to plan a front or to cover a map, with the tours of the earlier front.
"""

from collections.abc import Mapping, Sequence
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Base64Bytes, BaseModel, ConfigDict, Field

from service.actor_info import ActorInfo
from service.replanning.earlier_tours import EarlierTours
from service.requests.arrays import costs_array
from service.requests.coverage import CoverageRequest, parse_coverage_as
from service.requests.day_fields import DayObjectiveItem
from service.requests.fields import Cost, Items, OneEach
from service.requests.front import FrontRequest, parse_front_as
from service.requests.limits import Limits
from service.requests.parser import coverage_task, front_task
from service.requests.stops import Changed, Matrix, Source, Stop, changed_costs
from service.requests.task import Task, TaskSource


def parse_rest(source: TaskSource, limits: Limits, actors: Mapping[str, ActorInfo]) -> Task:
    """Return the task of such a request; errors are those of `parse_task`."""
    if source.kind == "replan":
        stops = parse_front_as(RestRequest, source.body, limits, source.upload)
        return front_task(
            stops, stops.subject, limits, actors, labels=stops.labels, earlier=stops.earlier
        )
    places = parse_coverage_as(RestOfMapRequest, source.body, limits, source.upload)
    return coverage_task(places, places.coverage(), actors, places.earlier)


# Without AsInteger: the service wrote these numbers itself, and there may be 100,000 of them.
Index = Annotated[int, Field(ge=0, le=2**31 - 1)]
_STOP = np.dtype("<i4")  # of a tour, in base64, which is read four times as fast as JSON


class EncodedTours(BaseModel):
    """Tours that all have the same number of stops."""

    model_config = ConfigDict(defer_build=True)

    count: int = Field(ge=1)
    stops: Base64Bytes = Field(description="of one tour after another, four bytes each")

    def tours(self) -> NDArray[np.int64]:
        """Return the tours, shape (count, k)."""
        stops = np.frombuffer(self.stops, _STOP).astype(np.int64)
        return stops.reshape(self.count, -1)


class EarlierMembers(BaseModel):
    """The rest of the tours of an earlier front, as the service writes it."""

    model_config = ConfigDict(defer_build=True)

    earlier_tours: EncodedTours = Field(
        description="what is left of each tour, first of the one being driven"
    )
    min_kept: float = Field(default=0.0, ge=0, le=1, allow_inf_nan=False)
    balance: float | None = Field(
        default=None, ge=0, le=1, description="of the tour being driven, in the earlier front"
    )
    touched: Items[Index] | None = Field(
        default=None, description="the stops at which these may have become worse; null is any"
    )

    @property
    def earlier(self) -> EarlierTours:
        """The rest of the earlier tours."""
        touched = None if self.touched is None else np.array(self.touched, np.int64)
        tours = self.earlier_tours.tours()
        return EarlierTours(tours, self.min_kept, touched, self.balance)


_Step = tuple[Index, Index, Cost | None]


class RestObjective(DayObjectiveItem):
    """An objective with the costs of some steps changed, each as origin, destination and cost.

    A cost is null if there is no longer a way.
    """

    changed: Items[_Step] = Field(default_factory=list)

    def source(self, part: str, stops: Sequence[Stop]) -> Source:
        """Return the source of the costs between these stops, with the changed costs."""
        base = self.fixed_source(part, stops)
        if not self.changed:
            return base
        steps = np.array([step[:2] for step in self.changed], np.int64)
        costs = costs_array([step[2] for step in self.changed])
        if isinstance(base, Matrix):
            return Matrix(changed_costs(base.costs, steps, costs))
        assert not isinstance(base, Changed)
        return Changed(base, steps, costs)


class RestRequest(EarlierMembers, FrontRequest):
    """The rest of a way: its stops, costs and ends, and what is left of the earlier tours."""

    objectives: OneEach[RestObjective] = Field(default_factory=list)  # type: ignore[assignment]


class RestOfMapRequest(EarlierMembers, CoverageRequest):
    """The rest of a way over a map: the map, the places left, and what is left of the tours."""
