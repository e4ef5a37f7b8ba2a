"""PA-One for matrices of costs, which need not be symmetric: it joins paths that have no direction.

Where costs differ by direction, a path knows by how much it would rather be gone along one way
than the other, and each edge to it is judged in the way that then costs less. Of a finished tour
the cheaper direction is taken. On symmetric matrices nothing of this is left.

A tour leaves each city once and enters it once. So a price for each that is taken off the costs
of its steps changes all tours by the same, and what is left of the costs says more about which
steps a tour wants: after the best prices of the assignment problem, only those that an optimal
assignment may take cost nothing. The prices here are of the assignment problem with entropy,
which come from a few products of matrices (Sinkhorn's iteration; Cuturi, 2013, arXiv:1306.0895).
They are found for some weights, and between these drawn in straight lines: wrong prices do no
harm to any tour.
"""

import torch
from jaxtyping import Float
from torch import Tensor

from models.networks.candidates import Costs, Prices, padded_matrices, weighted_costs
from models.networks.fragments import NEVER
from models.networks.matrix_features import unit_matrices
from models.networks.pa_one import OneActor

_WEIGHTS = 9  # for which prices are found
_CHEAPEST = 4  # steps of each city, whose mean is the unit of the temperature
_TEMPERATURE = 0.5
_ITERATIONS = 10
_LEAST_UNIT = 1e-6
_LEAST = 1e-30  # entry of a kernel: a city so far from all others gets no higher price


class OneMatrixActor(OneActor):
    """PA-One for matrices. Of the configuration it takes width, layers and feedforward."""

    reads = "matrices"
    has_directions = True
    repair_joinings = 2

    def costs(self, instance: Float[Tensor, "2 n n"]) -> Costs:
        """Return the costs of the steps of one instance in units of the largest of each matrix."""
        return padded_matrices(unit_matrices(instance[None])[0])

    def prices(self, costs: Costs, weights: Float[Tensor, "r 2"]) -> Prices:
        """Return the prices that are taken off the costs of each row."""
        return priced(costs, weights)


def priced(costs: Costs, weights: Float[Tensor, "r 2"]) -> Prices:
    """Return the prices of the cities under the weights of each row, costs by objective."""
    first = torch.arange(_WEIGHTS, device=weights.device) / (_WEIGHTS - 1)
    known = _prices(weighted_costs(costs, torch.stack((first, 1 - first), dim=1).to(weights)))
    steps = (weights[:, :1] - first.to(weights)).abs() * (_WEIGHTS - 1)
    shares = (1 - steps).clamp(min=0)  # (r, weights)
    return Prices(shares @ known.fees, shares @ known.tilts)


def _prices(costs: Costs) -> Prices:
    """Return the prices of the cities in each row of costs, which have leans."""
    means, leans = costs
    assert leans is not None
    n = means.shape[1]
    there, back = means + leans, means - leans
    unit = _unit(torch.cat((there, back), dim=1))[:, None] * _TEMPERATURE
    kernel, back_kernel = (
        (-table[:, :, :n] / unit[..., None]).exp().clamp(min=_LEAST) for table in (there, back)
    )
    leave, enter = kernel.sum(dim=2).rsqrt(), back_kernel.sum(dim=2).rsqrt()
    for _ in range(_ITERATIONS):
        leave, enter = (
            (leave / _product(kernel, enter)).sqrt(),
            (enter / _product(back_kernel, leave)).sqrt(),
        )
    leave, enter = unit * leave.log(), unit * enter.log()
    return Prices((leave + enter) / 2, (leave - enter) / 2)


def _product(tables: Float[Tensor, "g n n"], of: Float[Tensor, "g n"]) -> Float[Tensor, "g n"]:
    return (tables @ of[..., None]).squeeze(2)


def _unit(costs: Float[Tensor, "g two_n m"]) -> Float[Tensor, " g"]:
    """Return the mean of the cheapest steps from and to each city."""
    cheapest = costs.topk(_CHEAPEST, largest=False).values
    real = cheapest < NEVER / 2
    total = torch.where(real, cheapest, 0.0).sum(dim=(1, 2))
    return (total / real.sum(dim=(1, 2)).clamp(min=1)).clamp(min=_LEAST_UNIT)
