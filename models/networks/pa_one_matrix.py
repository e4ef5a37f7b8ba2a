"""PA-One for matrices of costs, which need not be symmetric: it joins paths that have no direction.

Where costs differ by direction, a path knows by how much it would rather be gone along one way
than the other, and each edge to it is judged in the way that then costs less. Of a finished tour
the cheaper direction is taken. On symmetric matrices nothing of this is left.

Candidates come from shortlists while many ends are open. What is left is a small problem, of which
all pairs are looked at.
"""

from jaxtyping import Float, Int
from torch import Tensor

from models.networks.joining.candidates import Candidates, toured
from models.networks.joining.contraction import contracted, expanded
from models.networks.joining.costs import Costs, Problem, padded_matrices
from models.networks.joining.fragments import Fragments, all_alone
from models.networks.joining.prices import prices_at_knots, prices_between
from models.networks.joining.shortlists import (
    LEAST,
    RowLists,
    Shortlists,
    first_of,
    listed_candidates,
    lists_of_rows,
    shortlists,
)
from models.networks.matrix_features import unit_matrices
from models.networks.pa_one import OneActor

_SHARE = 2  # of the cities may be open ends, among fewer of which all pairs are looked at


class OneMatrixActor(OneActor):
    """PA-One for matrices. Of the configuration it takes width, layers and feedforward."""

    reads = "matrices"
    has_directions = True
    repair_joinings = 2

    def costs(self, instance: Float[Tensor, "2 n n"]) -> Costs:
        """Return the costs of the steps of one instance in units of the largest of each matrix."""
        return padded_matrices(unit_matrices(instance[None])[0])

    def problem(self, instance: Float[Tensor, "2 n n"], weights: Float[Tensor, "r 2"]) -> Problem:
        """Return the problem that one instance is under the weights of each row."""
        return self.listed_problem(instance, weights)[0]

    def listed_problem(
        self, instance: Float[Tensor, "2 n n"], weights: Float[Tensor, "r 2"]
    ) -> tuple[Problem, Shortlists]:
        """Return the problem that one instance is, and the shortlists of its cities."""
        costs = self.costs(instance)
        known = prices_at_knots(costs)
        return Problem(costs, weights, prices_between(weights, known)), shortlists(costs, known)

    def first_candidates(self, problem: Problem) -> Candidates:
        """Return the candidates while all cities are alone."""
        return first_of(self._lists(problem))

    def built(self, problem: Problem) -> Int[Tensor, "r n"]:
        """Return the tours that are built for the rows of a problem."""
        lists = self._lists(problem)
        assert problem.prices is not None
        fragments = all_alone(problem.prices.fees, leaning=True)
        after = self.round(problem, fragments, first_of(lists), self.joinings)
        while bool(are_listed(fragments, after)):
            fragments = after.trimmed()
            candidates = listed_candidates(lists, fragments)
            after = self.round(problem, fragments, candidates, self.joinings)
        fragments = after.trimmed()
        solved = self.joined_to_one(*contracted(problem, fragments))
        return toured(problem, expanded(fragments, solved))

    @staticmethod
    def _lists(problem: Problem) -> RowLists:
        lists = shortlists(problem.costs, prices_at_knots(problem.costs))
        return lists_of_rows(lists, problem.weights)


def are_listed(before: Fragments, after: Fragments) -> Tensor:
    """Return whether the candidates of the next look are to come from lists.

    They are while many ends are open in some row, if the last look joined some in each such row.
    """
    n = (after.links.shape[1] - 1) // 2
    count = after.open.sum(dim=1)
    many = (count > LEAST) & (_SHARE * count > n)
    return many.any() & ~(many & (after.left == before.left)).any()
