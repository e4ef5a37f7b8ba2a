"""PA-One: an actor that joins cities to paths, and paths to a tour, by the logits of a network.

A tour grows everywhere at once, as in the greedy edge heuristic (Bentley, 1992). In each round
every end of a path has its nearest ends as candidates, by the costs of a preference; a network
gives the log-odds of each edge to them; and the edges that no better one stands against are
taken. The candidates of the ends that are left are found anew in the next round, so that the
network always sees the problem as it then is: a smaller one of the same kind. It knows nothing of
coordinates, preferences or the number of cities, only the costs of edges between neighbours,
against each other; which is why it does as well at 1000 cities as at the 20 to 180 that it
learned from.
"""

from typing import ClassVar, Literal

import torch
from jaxtyping import Bool, Float, Int
from torch import Generator, Tensor, nn

from models import rollout_pa_one
from models.data.preferences import FLAT, turned_outwards, weights
from models.networks.actor import Actor, Architecture
from models.networks.joining.candidates import (
    Candidates,
    cheapest_candidates,
    grown_at_cost,
    no_more_possible,
    partner_costs,
    toured,
    without_impossible,
)
from models.networks.joining.closing import ENOUGH, joined_to_one
from models.networks.joining.contraction import contracted, expanded
from models.networks.joining.costs import CANDIDATES, Costs, Matrices, Planes, Prices, Problem
from models.networks.joining.features import features_seen
from models.networks.joining.fragments import (
    MOST_LOGIT,
    Fragments,
    all_alone,
    linked,
    mutual_best,
)
from models.networks.joining.messages import MessagePassingLayer
from models.networks.joining.neighbours import EDGE, Neighbours, of_both_ends
from models.networks.joining.prices import priced_problem
from models.networks.joining.repairs import cut, laid_out, repair_problem
from models.networks.joining.shortlists import (
    RowLists,
    Sizes,
    first_of,
    listed_candidates,
    lists_of_rows,
    own_lists,
    shortlists,
)
from models.networks.layers import feedforward
from models.networks.rows import stacked
from models.rollout_pa_one import Judgement
from models.rollout_repairs import (
    RepairState,
    as_repaired,
    cities_to_cut,
    from_the_first_city,
    least_costs,
    sizes_of_cut,
    state_after_repair,
    unrepaired,
)

MANY = 1000  # cities, more than which are joined three times a look

_STEEPNESS = 1.5  # how fast logits fall with such a cost, at first
# Of the costs of cities: moves so small show which comparisons were close.
_LEAST_ROUNDING, _ROUNDING_OF_A_CITY = 1e-6, 1e-8  # sums of more floats are less exact
_ROUNDINGS = 40  # times that cities are moved so, at most: 8 miss one close comparison in eight


def rows_of(preferences: Float[Tensor, "k m"]) -> Float[Tensor, "k m"]:
    """Return the weights of the row of each preference."""
    if preferences.shape[1] == FLAT:
        preferences = turned_outwards(preferences)
    return weights(preferences)


class OneActor(Actor):
    """PA-One. Of the configuration it takes width, layers and feedforward."""

    reads: ClassVar[Literal["coordinates", "matrices"]] = "coordinates"
    construction = "fragments"
    precisions = ("float32",)
    imitates_starts = False  # it learns edges
    repairs_tours = True
    most_objectives = 4  # the most that were tried: the network does not see their number
    has_directions: ClassVar[bool] = False  # or all steps cost as much as the step back
    candidates: ClassVar[int] = CANDIDATES  # of each end
    # Of fragments, for one evaluation of the network: in building tours, in building those of many
    # cities after the first evaluation, and in repairing tours. After eight, nearly all rows have
    # few enough fragments left to close them.
    joinings: ClassVar[int] = 2
    joinings_of_many: ClassVar[int] = 3  # an eighth less time for 0.01 of hypervolume at most
    repair_joinings: ClassVar[int] = 8
    last_joinings: ClassVar[int] = 6  # after the first evaluation
    list_sizes: ClassVar[Sizes] = Sizes(5, length=48, short=16, ends=256, share=32)

    def __init__(self, config: Architecture) -> None:
        super().__init__()
        inputs = 5 * self.candidates + 6 + self.has_directions * (self.candidates + 1)
        self.embed = feedforward(inputs, config.width, config.feedforward)
        self.layers = nn.ModuleList(
            MessagePassingLayer(config.width, config.feedforward, self.candidates)
            for _ in range(config.layers)
        )
        self.project_end = nn.Linear(config.width, (1 + self.has_directions) * EDGE)
        self.project_edge = nn.Linear(2 + self.has_directions, EDGE, bias=False)
        self.judge = nn.Linear(EDGE, 1, bias=False)

    @property
    def encoder_layers(self) -> nn.ModuleList:
        """The layers in which ends send each other messages."""
        return self.layers

    def costs(self, instance: Tensor) -> Planes | Matrices:
        """Return the costs of one instance in each objective."""
        return Planes(instance)

    def edge_logits(
        self, costs: Costs | Problem, fragments: Fragments, candidates: Candidates
    ) -> Float[Tensor, "r e c"]:
        """Return the log-odds of each edge to a candidate; -NEVER where it is impossible."""
        near = Neighbours(candidates, fragments.partners)
        seen = features_seen(partner_costs(costs, fragments), fragments, candidates, near)
        features = self.embed(seen.of_ends.flatten(0, 1))
        for layer in self.layers:
            features = layer(features, near)
        hidden = of_both_ends(self.project_end(features), near, seen.directions)
        hidden = hidden + self.project_edge(seen.of_edges.flatten(0, 1))
        relative = seen.relative_costs
        logits = self.judge(hidden.relu()).view_as(relative) - _STEEPNESS * relative
        logits = logits.clamp(-MOST_LOGIT, MOST_LOGIT)
        return without_impossible(logits, ~candidates.real)

    @torch.no_grad()
    def tours(self, instances: Tensor, preferences: Float[Tensor, "k m"]) -> Int[Tensor, "b k n"]:
        """Return the greedy tour of each instance for each preference."""
        rows = rows_of(preferences)
        return torch.stack([self.built(self.problem(instance, rows)) for instance in instances])

    @torch.no_grad()
    def repaired_tours(
        self, instances: Tensor, preferences: Float[Tensor, "k m"], repairs: int
    ) -> tuple[Int[Tensor, "b k n"], Int[Tensor, "b k n"]]:
        """Return the greedy tours after the repairs, and as many others that they visited."""
        rows = rows_of(preferences)
        built = self.tours(instances, preferences)
        states = [
            self._repaired(self.problem(instance, rows), tours, repairs)
            for instance, tours in zip(instances, built, strict=True)
        ]
        tours = torch.stack([state.tours for state in states])
        return tours, torch.stack([state.visited for state in states])

    def _repaired(self, problem: Problem, tours: Int[Tensor, "r n"], repairs: int) -> RepairState:
        least = least_costs(self.first_candidates(problem))
        state = unrepaired(problem.costs, tours)
        for number in torch.arange(repairs):
            places = state.tours, state.freshness
            sizes = sizes_of_cut(tours.shape[1], int(number))
            cities = cities_to_cut(problem, least, places, number, sizes)
            cuts = cut(state.tours, cities)
            between, fragments = repair_problem(as_repaired(problem, state.points), cuts)
            joined = self.rejoined(between, fragments)
            new = laid_out(cuts, joined)
            state = state_after_repair(problem.costs, problem.weights, state, cities, new)
        return state

    def are_ties(
        self,
        instance: Tensor,
        preferences: Float[Tensor, "k m"],
        repairs: int,
        both: tuple[Int[Tensor, "k n"], Int[Tensor, "k n"]],
    ) -> Bool[Tensor, " k"]:
        """Return which tours are equal, or become others when cities are moved a little.

        Edges are chosen by many comparisons at once; small moves show which of them were close.
        """
        tours, expected = both
        ties = (tours == expected).all(dim=1)
        if ties.all():
            return ties
        differ = ~ties
        if repairs == 0:  # rows are apart
            preferences, expected, differ = preferences[differ], expected[differ], differ[differ]
        moved_away = ~differ
        rounding = max(_LEAST_ROUNDING, _ROUNDING_OF_A_CITY * tours.shape[1])
        generator = Generator().manual_seed(0)
        for _ in range(_ROUNDINGS):
            moved = instance * (1 + rounding * torch.randn(instance.shape, generator=generator))
            again = self.repaired_tours(moved, preferences, repairs)[0][0]
            if repairs > 0:
                again = from_the_first_city(again)
            moved_away |= (again != expected).any(dim=1)
            if moved_away.all():
                break
        ties[~ties] = moved_away[differ]
        return ties

    def problem(self, instance: Tensor, weights: Float[Tensor, "r m"]) -> Problem:
        """Return the problem that one instance is under the weights of each row."""
        costs = self.costs(instance)
        if weights.shape[1] > FLAT:
            return Problem(costs, weights, self.own_prices(costs, weights))
        return priced_problem(costs, weights, self.known_prices(costs))

    def known_prices(self, costs: Planes | Matrices) -> Prices | None:  # noqa: ARG002
        """Return the prices of the cities at each knot of two objectives, if there are any."""
        return None

    def own_prices(
        self,
        costs: Planes | Matrices,  # noqa: ARG002
        weights: Float[Tensor, "r m"],  # noqa: ARG002
    ) -> Prices | None:
        """Return the prices of the cities in each row, if there are any."""
        return None

    def first_candidates(self, problem: Problem) -> Candidates:
        """Return the candidates while all cities are alone."""
        return first_of(self.lists(problem), self.candidates)

    def lists(self, problem: Problem) -> RowLists:
        """Return the shortlists of each row."""
        costs, sizes = problem.costs, self.list_sizes
        length = sizes.length_of(costs.n)
        if problem.weights.shape[1] > FLAT:
            return own_lists(problem, length)
        lists = shortlists(costs, sizes.knots, length, self.known_prices(costs))
        return lists_of_rows(lists, problem.weights)

    def built(self, problem: Problem) -> Int[Tensor, "r n"]:
        """Return the tours that are built for the rows of a problem."""
        lists = self.lists(problem)
        joinings = self.joinings_of_many if problem.costs.n > MANY else self.joinings
        fragments = all_alone(lists.means[..., 0], leaning=self.has_directions)
        after = self.round(problem, fragments, first_of(lists, self.candidates), self.joinings)
        while bool(self.are_listed(fragments, after)):
            fragments = after.trimmed()
            candidates = self.candidates_from(lists, fragments)
            after = self.round(problem, fragments, candidates, joinings)
        fragments = after.trimmed()
        solved = self.joined_to_one(*contracted(problem, fragments), self.joinings)
        return toured(problem, expanded(fragments, solved))

    def are_listed(self, before: Fragments, after: Fragments) -> Bool[Tensor, ""]:
        """Return whether the candidates of the next round come from lists.

        They do while the last round joined fragments in some row with many open ends. After that
        the problem is contracted to the open ends, and all pairs of them are candidates.
        """
        return (self._many_open(after) & (after.left < before.left)).any()

    def candidates_from(self, lists: RowLists, fragments: Fragments) -> Candidates:
        """Return the candidates of ends from lists, in rows in which many are open."""
        return listed_candidates(lists, fragments, self._many_open(fragments), self.candidates)

    def _many_open(self, fragments: Fragments) -> Bool[Tensor, " r"]:
        n = (fragments.links.shape[1] - 1) // 2
        count = fragments.open.sum(dim=1)
        return (count > self.list_sizes.ends) & (self.list_sizes.share * count > n)

    def joined_to_one(self, costs: Costs, fragments: Fragments, joinings: int) -> Fragments:
        """Join the few fragments of each row to one, the last five in the cheapest way.

        The network is evaluated once for each `joinings` joinings.
        """
        while bool((fragments.left > ENOUGH).any()):
            fragments = self.round_of_few(costs, fragments, joinings).trimmed()
        return joined_to_one(costs, fragments)

    def rejoined(self, costs: Costs, fragments: Fragments) -> Fragments:
        """Join what a repair has left of each row to one fragment."""
        after = self.round_of_few(costs, fragments.trimmed(), self.repair_joinings)
        return self.joined_to_one(costs, after.trimmed(), self.last_joinings)

    def round_of_few(self, costs: Costs, fragments: Fragments, joinings: int) -> Fragments:
        """Return the fragments after joinings in rows in which more are left than are closed."""
        more = (fragments.left > ENOUGH)[:, None]
        to_join = fragments._replace(open=fragments.open & more)
        candidates = cheapest_candidates(costs, to_join, self.candidates)
        return self.round(costs, fragments, candidates, joinings, ENOUGH)

    def round(
        self,
        costs: Costs | Problem,
        fragments: Fragments,
        candidates: Candidates,
        joinings: int,
        enough: int = 1,
    ) -> Fragments:
        """Return the fragments after joining them, `joinings` times, by the best of these edges.

        After the first time, rows with no more than `enough` fragments stay as they are.
        """
        logits = self.edge_logits(costs, fragments, candidates)
        mates = [mutual_best(fragments, candidates.positions, logits)]
        growing = [fragments, grown_at_cost(costs, fragments, mates[0])]
        left = fragments.left
        for _ in range(joinings - 1):
            after = growing[-1]
            if enough > 1:
                left = left - (mates[-1] >= 0).sum(dim=1) // 2
                after = after._replace(open=after.open & (left > enough)[:, None])
            logits = without_impossible(logits, no_more_possible(candidates, fragments, after))
            mates.append(mutual_best(after, candidates.positions, logits))
            growing.append(grown_at_cost(costs, growing[-1], mates[-1]))
        return linked(growing, mates)

    def judgement(self, joinings: int) -> Judgement:
        """Return how this actor judges edges, once for each `joinings` joinings."""
        return Judgement(self.edge_logits, self.candidates, joinings)

    def _weighted_one_by_one(self, instances: Tensor, weights: Float[Tensor, "k m"]) -> Costs:
        """Return the costs under the weights of each row of each instance, one after the other."""
        return stacked([self.problem(instance, weights).tables for instance in instances])

    def sampled_tours_with_log_likelihoods(
        self,
        instances: Tensor,
        preferences: Float[Tensor, "k m"],
        times: int,
        start_generator: Generator,  # noqa: ARG002, its tours start nowhere
        generator: Generator,
    ) -> tuple[Int[Tensor, "b kt n"], Float[Tensor, "b kt"]]:
        """Draw tours as often for each preference in turn, and return their log-likelihoods."""
        rows = weights(preferences).repeat_interleave(times, dim=0)
        costs = self._weighted_one_by_one(instances, rows)
        tours, likelihoods = rollout_pa_one.sampled_tours(
            self.judgement(self.joinings), costs, generator
        )
        by_instance = (len(instances), -1)
        return tours.unflatten(0, by_instance), likelihoods.unflatten(0, by_instance)

    def imitation_loss(
        self,
        instances: Tensor,
        preferences: Float[Tensor, "k m"],
        tours: Int[Tensor, "b k n"],
    ) -> Float[Tensor, ""]:
        """Return the binary cross-entropy of each edge to a candidate, summed, for each end."""
        costs = self._weighted_one_by_one(instances, weights(preferences))
        return rollout_pa_one.imitation_loss(
            self.judgement(self.joinings), costs, tours.flatten(0, 1)
        )
