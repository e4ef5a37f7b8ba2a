"""Costs of steps: in each objective, under the weights of each row, and minus prices of cities.

A row is one tour under construction. Its costs depend on its preference. Below, o counts
objectives.
"""

from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from models.data.instances import distance_matrices
from models.networks.joining.fragments import NEVER
from models.networks.rows import changed

CANDIDATES = 8  # the most candidates of an end of a path


class Costs(NamedTuple):
    """The mean cost of each step and the step back, and the lean: the step's cost minus the mean.

    Leans are None if steps back cost the same. A table of all steps ends with extra columns for
    cities that are never reached, one for each candidate that an end may have. Arrays of single
    steps may have any shape.
    """

    means: Float[Tensor, "r n m"]
    leans: Float[Tensor, "r n m"] | None = None

    @property
    def cheaper_way(self) -> Tensor:
        """The smaller of the costs of each step and of the step back."""
        return self.means if self.leans is None else self.means - self.leans.abs()

    def steps(
        self, starts: Int[Tensor, "r e"], stops: Int[Tensor, "r e"]
    ) -> tuple[Float[Tensor, "r e"], Float[Tensor, "r e"] | None]:
        """Return the means of the costs of steps in each row, and their leans, if there are any."""
        entries = starts * self.means.shape[2] + stops
        means, leans = changed(self, lambda table: table.flatten(1).gather(1, entries))
        return means, leans


class Prices(NamedTuple):
    """The price of each city by itself, in each row: half a fee for the way there and the way on.

    The fee is taken off the cost of every step to a city and from it; the tilt is taken off that
    of the steps from the city, and put on those to it. The cost of no tour changes by more than
    that of another.
    """

    fees: Float[Tensor, "r n"]
    tilts: Float[Tensor, "r n"]


class Planes(NamedTuple):
    """Costs in each objective that are distances between cities in a plane."""

    cities: Float[Tensor, "n x"]  # x and y in each plane in turn

    @property
    def n(self) -> int:
        """The number of cities."""
        return self.cities.shape[0]

    @property
    def tables(self) -> Costs:
        """The costs of all steps, (o, n, m)."""
        index = torch.arange(self.cities.shape[0], device=self.cities.device)
        return Costs(_padded(distance_matrices(self.cities[None])[0], index))

    def steps(self, starts: Int[Tensor, "r e"], stops: Int[Tensor, "r e"]) -> Costs:
        """Return the costs of steps, (o, r, e)."""
        return Costs(_distances(self._of(starts), self._of(stops)))

    def along(self, tours: Int[Tensor, "r n"]) -> Costs:
        """Return the costs of the steps from each place of a tour to the next, (o, r, n)."""
        places = self._of(tours)  # exported, rolling them takes less time than looking up others
        return Costs(_distances(places, places.roll(-1, dims=2)))

    def between(self, cities: Int[Tensor, "r e"]) -> Costs:
        """Return the costs of the steps between these cities of each row, (o, r, e, e)."""
        places = self._of(cities)
        return Costs(_distances(places[..., None], places[..., None, :]))

    def beginning_at(self, cities: Int[Tensor, " r"]) -> Costs:
        """Return the costs of the steps from one city in each row to all, (o, r, n)."""
        return Costs(_distances(self._of(cities[:, None]), self.cities.T[:, None]))

    def _of(self, cities: Int[Tensor, "r e"]) -> Float[Tensor, "x r e"]:
        # Of single numbers ONNX Runtime gathers those of each axis by themselves faster.
        in_each = cities.flatten()[None].expand(self.cities.shape[1], -1)
        return self.cities.T.gather(1, in_each).unflatten(1, cities.shape)


class Matrices(NamedTuple):
    """Costs in each objective that are the entries of a matrix, as means and leans."""

    means: Float[Tensor, "o n m"]
    leans: Float[Tensor, "o n m"]

    @property
    def n(self) -> int:
        """The number of cities."""
        return self.means.shape[1]

    @property
    def tables(self) -> Costs:
        """The costs of all steps, (o, n, m)."""
        return Costs(self.means, self.leans)

    def steps(self, starts: Int[Tensor, "r e"], stops: Int[Tensor, "r e"]) -> Costs:
        """Return the costs of steps, (o, r, e)."""
        return self._at(starts * self.means.shape[2] + stops)

    def along(self, tours: Int[Tensor, "r n"]) -> Costs:
        """Return the costs of the steps from each place of a tour to the next, (o, r, n)."""
        return self.steps(tours, tours.roll(-1, dims=1))

    def between(self, cities: Int[Tensor, "r e"]) -> Costs:
        """Return the costs of the steps between these cities of each row, (o, r, e, e)."""
        pairs = cities[:, :, None] * self.means.shape[2] + cities[:, None, :]
        return self._at(pairs)

    def beginning_at(self, cities: Int[Tensor, " r"]) -> Costs:
        """Return the costs of the steps from one city in each row to all, (o, r, n)."""
        n = self.means.shape[1]
        return Costs(*(table.index_select(1, cities)[..., :n] for table in self))

    def _at(self, entries: Int[Tensor, "..."]) -> Costs:
        # Of single numbers ONNX Runtime gathers those of each objective by themselves faster.
        in_each = entries.flatten()[None].expand(self.means.shape[0], -1)
        return Costs(
            *(table.flatten(1).gather(1, in_each).view(-1, *entries.shape) for table in self)
        )


def _distances(
    starts: Float[Tensor, "x ..."], stops: Float[Tensor, "x ..."]
) -> Float[Tensor, "o ..."]:
    """Return the distances in all planes, the same floats as `distance_matrices` has."""
    apart = starts - stops  # exported, a product takes less time than a power
    squares = apart * apart
    return (squares[0::2] + squares[1::2]).sqrt()


class Problem(NamedTuple):
    """The costs in each objective, the weights of each row, and its prices where costs lean.

    It gives the same costs of steps as a table for each row would, but no such table is made.
    """

    costs: Planes | Matrices
    weights: Float[Tensor, "r o"]
    prices: Prices | None = None

    @property
    def tables(self) -> Costs:
        """The costs of all steps in each row."""
        return weighted_costs(self.costs.tables, self.weights, self.prices)

    def steps(
        self, starts: Int[Tensor, "r e"], stops: Int[Tensor, "r e"]
    ) -> tuple[Float[Tensor, "r e"], Float[Tensor, "r e"] | None]:
        """Return the means of the costs of steps in each row, and their leans, if there are any."""
        in_each = self.costs.steps(starts, stops)
        costs = changed(in_each, lambda lengths: weighted_sums(lengths, self.weights))
        if self.prices is None:
            return costs
        return without_prices(
            costs,
            changed(self.prices, lambda part: part.gather(1, starts)),
            changed(self.prices, lambda part: part.gather(1, stops)),
        )


def along(costs: Planes | Matrices, tours: Int[Tensor, "r n"]) -> Costs:
    """Return the costs in each objective from each place of a tour to the next, (o, r, n)."""
    return costs.along(tours)


def padded_matrices(matrices: Float[Tensor, "o n n"]) -> Matrices:
    """Return the costs in each objective, a row each; no city has itself for a neighbour."""
    back = matrices.transpose(1, 2)
    leans = nn.functional.pad((matrices - back) / 2, (0, CANDIDATES))
    index = torch.arange(matrices.shape[1], device=matrices.device)
    return Matrices(_padded((matrices + back) / 2, index), leans)


def _padded(costs: Float[Tensor, "x n n"], index: Int[Tensor, " n"]) -> Float[Tensor, "x n m"]:
    """Return the costs with NEVER for steps to the same city, and in columns more."""
    own = torch.where(index == index[:, None], NEVER, 0.0)
    return nn.functional.pad(costs + own, (0, CANDIDATES), value=NEVER)


def weighted_costs(
    costs: Costs, weights: Float[Tensor, "r o"], prices: Prices | None = None
) -> Costs:
    """Return the cost of each step under the weights of each row, from those in each objective.

    Where there are prices, what a tour costs in all falls by as much for every tour of a row.
    """
    weighted = changed(costs, lambda table: _weighted(table, weights))
    return weighted if prices is None else without(weighted, prices)


def without(costs: Costs, prices: Prices) -> Costs:
    """Return the costs without the prices of both cities of each step."""
    return without_prices(
        costs,
        changed(prices, lambda part: part[..., None]),
        changed(prices, lambda part: nn.functional.pad(part, (0, CANDIDATES))[:, None]),
    )


def without_prices(costs: Costs, of_starts: Prices, of_stops: Prices) -> Costs:
    """Return the costs of steps without these prices, which spread over them."""
    means = costs.means - of_starts.fees - of_stops.fees
    if costs.leans is None:
        return Costs(means)
    return Costs(means, costs.leans - of_starts.tilts + of_stops.tilts)


def costs_between(problem: Problem, cities: Int[Tensor, "r e"]) -> Costs:
    """Return the costs of the steps between these cities of each row, numbered as they come."""
    costs, weights, prices = problem
    in_each, e = costs.between(cities), cities.shape[1]
    index = torch.arange(e, device=cities.device)

    def weighted(table: Float[Tensor, "o r e e"]) -> Float[Tensor, "r e e"]:
        return weighted_sums(table.flatten(2), weights).unflatten(1, (e, e))

    leans = in_each.leans
    found = Costs(
        _padded(weighted(in_each.means), index),
        None if leans is None else nn.functional.pad(weighted(leans), (0, CANDIDATES)),
    )
    if prices is None:
        return found
    return without(found, changed(prices, lambda part: part.gather(1, cities)))


def weighted_sums(
    lengths: Float[Tensor, "o r x"], weights: Float[Tensor, "r o"]
) -> Float[Tensor, "r x"]:
    """Return the sum of the lengths under the weights of each row.

    ONNX Runtime adds few long tables by a product with ones four times as fast as by a sum.
    """
    products = weights.T[..., None] * lengths
    ones = torch.ones_like(weights[:1])
    return (ones @ products.flatten(1)).view_as(products[0])


def _weighted(costs: Float[Tensor, "o n m"], weights: Float[Tensor, "r o"]) -> Tensor:
    return (weights @ costs.flatten(1)).view(-1, costs.shape[1], costs.shape[2])
