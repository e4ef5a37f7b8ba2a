"""The pointer network of Nazari et al. (2018), arXiv:1802.04240, as DRL-MOA has it, and its critic.

Their convolutions see one city at a time, so they are linear layers here. The encoding of demands
that change, nought for tours, and dropout are left out.
"""

from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from models.networks.additive_attention import exponential, pointed
from models.rollout import Choose, greedily


class PointerMemory(NamedTuple):
    """Cities as the decoder needs them: their features, and both attentions' tables of them."""

    features: Float[Tensor, "b n d"]
    attended: Float[Tensor, "b n d"]
    pointed: Float[Tensor, "b n d"]


class PointerActor(nn.Module):
    """DRL-MOA's actor: a GRU reads the tour, its state attends to the cities, and points at one."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.embed_city = nn.Linear(4, width)
        self.embed_last = nn.Linear(4, width)
        self.follow = nn.GRU(width, width, batch_first=True)
        self.project_city = nn.Linear(width, 2 * width, bias=False)
        self.project_state = nn.Linear(width, width, bias=False)
        self.project_context = nn.Linear(width, width, bias=False)
        self.judges = nn.Parameter(torch.empty(2, width).uniform_(-1, 1) * (3 / width) ** 0.5)

    def remember(self, cities: Float[Tensor, "b n 4"]) -> PointerMemory:
        """Compute the tables of the instances."""
        features = self.embed_city(cities)
        tables = exponential(self.project_city(features)).chunk(2, dim=-1)
        return PointerMemory(features, *tables)

    def logits(
        self,
        memory: PointerMemory,
        states: Float[Tensor, "b t d"],
        visited: Bool[Tensor, "b t n"],
    ) -> Float[Tensor, "b t n"]:
        """Return unnormalised log-probabilities of the next city; minus infinity where visited."""
        none_visited = torch.zeros_like(visited)
        states = exponential(self.project_state(states))
        shares = pointed(memory.attended, states, self.judges[0], none_visited).softmax(dim=-1)
        contexts = exponential(self.project_context(shares @ memory.features))
        scores = pointed(memory.pointed, contexts, self.judges[1], visited)
        return scores.masked_fill(visited, -torch.inf)


class PointerCritic(nn.Module):
    """A predictor of the actor's objective: a sum over the cities."""

    def __init__(self, width: int) -> None:
        super().__init__()
        hidden = (nn.Linear(width, 20), nn.ReLU(), nn.Linear(20, 20), nn.ReLU())
        self.judge = nn.Sequential(nn.Linear(4, width), *hidden, nn.Linear(20, 1))

    def forward(self, cities: Float[Tensor, "b n 4"]) -> Float[Tensor, " b"]:
        """Return the prediction for each instance."""
        judged: Tensor = self.judge(cities).sum(dim=(1, 2))
        return judged


@torch.no_grad()
def build_tours(
    actor: PointerActor, cities: Float[Tensor, "b n 4"], choose: Choose = greedily
) -> Int[Tensor, "b n"]:
    """Build a tour of each instance; the first city is chosen too."""
    b, n, _ = cities.shape
    memory = actor.remember(cities)
    visited = torch.zeros(b, 1, n, dtype=torch.bool)
    last, state, tour = torch.zeros(b, 1, 4), None, []
    for _ in range(n):
        following, state = actor.follow(actor.embed_last(last), state)
        tour.append(choose(actor.logits(memory, following, visited)))  # (b, 1)
        visited.scatter_(-1, tour[-1][..., None], True)
        last = cities.gather(1, tour[-1][..., None].expand(-1, -1, 4))
    return torch.cat(tour, dim=1)


def log_likelihoods(
    actor: PointerActor, cities: Float[Tensor, "b n 4"], tours: Int[Tensor, "b n"]
) -> Float[Tensor, " b"]:
    """Return the log-likelihood of each tour, from all of its moments at once."""
    ordered = cities.gather(1, tours[..., None].expand(-1, -1, 4))
    before = torch.cat((torch.zeros_like(ordered[:, :1]), ordered[:, :-1]), dim=1)
    states, _ = actor.follow(actor.embed_last(before))
    visited = tours.argsort(dim=-1)[:, None] < torch.arange(tours.shape[1])[:, None]
    logits = actor.logits(actor.remember(cities), states, visited)
    return logits.log_softmax(dim=-1).gather(-1, tours[..., None]).sum(dim=(1, 2))
