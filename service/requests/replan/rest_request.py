"""The rest of a way as a request: one for a front or coverage, with the tours of the earlier front.

The service writes it from a request to replan, stores it and sends it to workers. So a front of a
rest can be replanned like any other.
"""

from typing import Annotated

import numpy as np
from pydantic import Field

from service.instance import OBJECTIVES
from service.replanning.earlier_tours import EarlierTours
from service.requests.arrays import costs_array
from service.requests.coverage import CoverageRequest
from service.requests.front import FrontRequest
from service.requests.replan.fields import Cost
from service.requests.replan.rest_members import EarlierMembers, Index
from service.requests.stop_fields import ObjectiveItem
from service.requests.stops import Changed, Matrix, Source, Stop, changed_costs
from service.requests.validation import invalid

_Step = tuple[Index, Index, Cost | None]


class RestObjective(ObjectiveItem):
    """An objective with the costs of some steps changed, each as origin, destination and cost.

    A cost is null where there is no longer a way.
    """

    changed: Annotated[list[_Step], Field(fail_fast=True)] = Field(default_factory=list)

    def source(self, part: str, stops: tuple[Stop, ...]) -> Source:  # type: ignore[override]
        """Return the source of the costs between these stops, with those that have changed."""
        base = super().source(part, stops)
        if not self.changed:
            return base
        steps = np.array([step[:2] for step in self.changed], np.int64)
        if steps.max() >= len(stops):
            raise invalid(f"{part}/changed", "must be of stops that there are")
        costs = costs_array([step[2] for step in self.changed])
        if isinstance(base, Matrix):
            return Matrix(changed_costs(base.costs, steps, costs))
        assert not isinstance(base, Changed)
        return Changed(base, steps, costs)


class RestRequest(EarlierMembers, FrontRequest):
    """The rest of a way: its stops, costs and ends, and what is left of the earlier tours."""

    objectives: Annotated[
        list[RestObjective],
        Field(min_length=OBJECTIVES, max_length=OBJECTIVES, fail_fast=True),
    ] = Field(default_factory=list)  # type: ignore[assignment]

    @property
    def earlier(self) -> EarlierTours:
        """What is left of the earlier tours; a refusal as of `earlier_of`."""
        return self.earlier_of(self.n, self.ends)


class RestOfMapRequest(EarlierMembers, CoverageRequest):
    """The rest of a way over a map: the map, the places left, and what is left of the tours."""

    @property
    def earlier(self) -> EarlierTours:
        """What is left of the earlier tours; a refusal as of `earlier_of`."""
        return self.earlier_of(len(self.places), self.ends)
