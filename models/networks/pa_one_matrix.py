"""PA-One for matrices of costs, which need not be symmetric: it joins paths that have no direction.

Where costs differ by direction, a path knows by how much it would rather be gone along one way
than the other, and each edge to it is judged in the way that then costs less. Of a finished tour
the cheaper direction is taken. On symmetric matrices nothing of this is left.
"""

from jaxtyping import Float
from torch import Tensor

from models.networks.joining.costs import Matrices, Planes, Prices, padded_matrices
from models.networks.joining.prices import KNOTS, own_prices, prices_at_knots
from models.networks.joining.shortlists import Sizes
from models.networks.matrix_features import unit_matrices
from models.networks.pa_one import OneActor


class OneMatrixActor(OneActor):
    """PA-One for matrices. Of the configuration it takes width, layers and feedforward."""

    reads = "matrices"
    has_directions = True
    candidates = 5
    joinings = 3
    repair_joinings = 2
    last_joinings = 2
    list_sizes = Sizes(KNOTS, length=24, short=24, ends=24, share=2)

    def costs(self, instance: Float[Tensor, "m n n"]) -> Matrices:
        """Return the costs of one instance in units of the largest of each matrix."""
        return padded_matrices(unit_matrices(instance[None])[0])

    def known_prices(self, costs: Planes | Matrices) -> Prices:
        """Return the prices of the cities at each knot."""
        assert isinstance(costs, Matrices)
        return prices_at_knots(costs)

    def own_prices(self, costs: Planes | Matrices, weights: Float[Tensor, "r m"]) -> Prices:
        """Return the prices of the cities in each row."""
        assert isinstance(costs, Matrices)
        return own_prices(costs, weights)
