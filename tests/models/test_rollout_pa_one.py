"""Tours drawn from PA-One."""

import torch
from torch import Generator, Tensor

from models.data.instances import tour_lengths, uniform_cities
from models.data.preferences import weights
from tests.helpers.small_actors import CPU, small_actor


def test_likelier_tours_are_drawn_more_often() -> None:
    """Following the gradient of the likelihood makes a tour be drawn more often."""
    actor = small_actor("pa-one")
    instances = uniform_cities(1, 6, Generator().manual_seed(4), CPU)
    preference = torch.tensor([[0.6, 0.8]])
    costs = weights(preference)[0]

    def draw(times: int, seed: int) -> tuple[Tensor, Tensor]:
        generator = Generator().manual_seed(seed)
        return actor.sampled_tours_with_log_likelihoods(
            instances, preference, times, Generator(), generator
        )

    def mean_cost() -> float:
        tours, _ = draw(500, 6)
        return float((tour_lengths(instances, tours) @ costs).mean())

    before = mean_cost()
    optimizer = torch.optim.Adam(actor.parameters(), lr=0.01)
    for seed in range(30):
        tours, likelihoods = draw(64, seed)
        lengths = tour_lengths(instances, tours) @ costs
        optimizer.zero_grad()
        ((lengths - lengths.mean()) * likelihoods).mean().backward()
        optimizer.step()
    assert mean_cost() < 0.98 * before
