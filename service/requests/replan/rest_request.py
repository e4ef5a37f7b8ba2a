"""The rest of a way as a request: a front request with the tours of the earlier front.

The service writes it from a request to replan, stores it and sends it to workers. So a front of a
rest can be replanned like any other.
"""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from service.instance import OBJECTIVES
from service.replanning.earlier_tours import EarlierTours
from service.requests.front import FrontRequest
from service.requests.replan.fields import Cost
from service.requests.stop_fields import ObjectiveItem
from service.requests.stops import Changed, Matrix, Source, Stop, changed_costs
from service.requests.validation import invalid

# Without AsInteger: these are the service's own, and a hundred thousand of them take a while.
_Index = Annotated[int, Field(ge=0, le=2**31 - 1)]
_Step = tuple[_Index, _Index, Cost]


class RestObjective(ObjectiveItem):
    """An objective with the costs of some steps changed, each as origin, destination and cost."""

    changed: Annotated[list[_Step], Field(fail_fast=True)] = Field(default_factory=list)

    def source(self, part: str, stops: tuple[Stop, ...]) -> Source:  # type: ignore[override]
        """Return the source of the costs between these stops, with those that have changed."""
        base = super().source(part, stops)
        if not self.changed:
            return base
        steps = np.array([step[:2] for step in self.changed], np.int64)
        if steps.max() >= len(stops):
            raise invalid(f"{part}/changed", "must be of stops that there are")
        costs = np.array([step[2] for step in self.changed], np.float64)
        if isinstance(base, Matrix):
            return Matrix(changed_costs(base.costs, steps, costs))
        assert not isinstance(base, Changed)
        return Changed(base, steps, costs)


class RestRequest(FrontRequest):
    """The rest of a way: its stops, costs and ends, and what is left of the earlier tours."""

    objectives: Annotated[
        list[RestObjective],
        Field(min_length=OBJECTIVES, max_length=OBJECTIVES, fail_fast=True),
    ] = Field(default_factory=list)  # type: ignore[assignment]
    earlier_tours: Annotated[
        list[Annotated[list[_Index], Field(fail_fast=True)]],
        Field(min_length=1, fail_fast=True),
    ] = Field(description="what is left of each tour, first of the one being driven")
    min_kept: float = Field(default=0.0, ge=0, le=1, allow_inf_nan=False)
    touched: Annotated[list[_Index], Field(fail_fast=True)] | None = Field(
        default=None, description="the stops at which these may have become worse; null is any"
    )

    @property
    def earlier(self) -> EarlierTours:
        """What is left of the earlier tours.

        Raises:
            Refusal: They are not tours of the same stops between the ends.
        """
        if len({len(tour) for tour in self.earlier_tours}) != 1:
            raise invalid("earlier_tours", "must be of one length")
        tours = np.array(self.earlier_tours, np.int64).reshape(len(self.earlier_tours), -1)
        if not self._are_tours(tours):
            raise invalid("earlier_tours", "must be of the same stops, between the ends")
        if self.touched is None:
            return EarlierTours(tours, self.min_kept)
        if max(self.touched, default=0) >= self.n:
            raise invalid("touched", "must be of stops that there are")
        return EarlierTours(tours, self.min_kept, np.array(self.touched, np.int64))

    def _are_tours(self, tours: NDArray[np.int64]) -> bool:
        if tours.shape[1] == 0:
            return True
        order = np.sort(tours, axis=1)
        ends = ((self.ends.start, 0), (self.ends.end, -1))
        return bool(
            (order == order[0]).all()
            and (np.diff(order[0]) > 0).all()
            and order[0, -1] < self.n
            and all(end is None or (tours[:, place] == end).all() for end, place in ends)
        )
