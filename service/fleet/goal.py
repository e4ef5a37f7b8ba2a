"""Say what a search of PyVRP minimises, and under which limits."""

from dataclasses import dataclass
from math import inf

from service.fleet.scales import UNBOUNDED

Weights = tuple[int, int]


@dataclass(frozen=True, kw_only=True)
class Goal:
    """The goal of a search: a weighted sum to minimise, and limits.

    Args:
        weights: The weights of distance and duration. That of the first objective is also the
            weight of fixed costs, and of prizes if they belong to it.
        prizes: The weight of prizes if they are the second objective.
        limit: The limit on the length of each route in the objective that is a maximum.
        vehicles: The most vehicles of each type; None for all.
        overtime: The limit on the overtime of each route.
        lateness: The limit on how much later than due a visit begins.
    """

    weights: Weights
    prizes: int = 0
    limit: int = UNBOUNDED
    vehicles: tuple[int, ...] | None = None
    overtime: float = inf
    lateness: float = inf


FREE = Goal(weights=(1, 1))  # the goal of solutions that were not found by a search
