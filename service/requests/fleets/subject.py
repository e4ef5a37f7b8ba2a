"""The fleet of a request before the costs between its stops are known."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from service.fleet.fleet import Fleet, Rules
from service.requests.stops import Array, Labels, RoadMeasure, Stops, cost_matrices


@dataclass(frozen=True, eq=False)
class UnmeasuredFleet:
    """The rules of a fleet, the names of its types of vehicles, and the sources of its costs."""

    rules: Rules
    vehicles: tuple[str, ...]
    stops: Stops

    @property
    def n(self) -> int:
        """The number of stops."""
        return self.rules.n

    def members(self, labels: Labels) -> dict[str, Any]:
        """Return the members of an answer that name the stops and objectives, ready for JSON."""
        members = labels.members
        objectives = zip(members["objectives"], self.rules.over, strict=True)
        return {**members, "objectives": [{**each, "over": over} for each, over in objectives]}

    def measured_by_road(self, costs: Mapping[RoadMeasure, Array]) -> "UnmeasuredFleet":
        """Return this fleet with a matrix, shape (n, n), in place of each measure by road."""
        return replace(self, stops=self.stops.measured_by_road(costs))

    def fleet(self) -> Fleet:
        """Return the fleet with its costs. O(n^2)."""
        return Fleet(rules=self.rules, costs=cost_matrices(self.stops))
