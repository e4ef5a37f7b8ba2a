"""Fragments that are joined until a tour is left."""

from itertools import combinations

import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Generator, Tensor

from models.networks.joining.fragments import (
    NEVER,
    Fragments,
    all_alone,
    first_open,
    impossible,
    joined,
    mutual_best,
)
from models.networks.joining.walks import tours_from


def greedy_edge(logits: Tensor) -> set[frozenset[int]]:
    """Edges from the highest logit on, if no city gets three and no cycle closes before the end."""
    n = len(logits)
    edges = sorted(combinations(range(n), 2), key=lambda edge: -float(logits[edge]))
    degree, group = [0] * n, list(range(n))
    taken = set()
    for i, j in edges:
        if max(degree[i], degree[j]) < 2 and group[i] != group[j]:
            taken.add(frozenset((i, j)))
            degree[i], degree[j] = degree[i] + 1, degree[j] + 1
            group = [group[i] if g == group[j] else g for g in group]
    return taken


def to_the_end(logits: Tensor) -> Fragments:
    """Joining by symmetric logits (r, n, n), all cities candidates of each other."""
    r, n, _ = logits.shape
    fragments = all_alone(logits[:, 0])
    candidates = torch.arange(n).expand(r, n, n)
    for _ in range(n):
        logits = torch.where(impossible(fragments, candidates), -NEVER, logits)
        fragments = joined(fragments, mutual_best(fragments, candidates, logits))
    assert (fragments.left == 1).all()
    return fragments


def toured(fragments: Fragments) -> Tensor:
    return tours_from(fragments, first_open(fragments))


def symmetric(entries: Tensor) -> Tensor:
    upper = entries.triu(1)
    return upper + upper.mT


@given(n=st.integers(2, 12), seed=st.integers(0, 1000))
def test_joining_what_nothing_better_stands_against_is_greedy_edge(n: int, seed: int) -> None:
    logits = symmetric(torch.randn(2, n, n, generator=Generator().manual_seed(seed)))
    tours = toured(to_the_end(logits))
    for tour, row in zip(tours, logits, strict=True):
        path = {frozenset(pair) for pair in zip(tour[:-1].tolist(), tour[1:].tolist(), strict=True)}
        assert path == greedy_edge(row)


@given(n=st.integers(2, 12), levels=st.integers(1, 3), seed=st.integers(0, 1000))
def test_equal_logits_end_in_a_tour_as_well(n: int, levels: int, seed: int) -> None:
    drawn = torch.randint(levels, (3, n, n), generator=Generator().manual_seed(seed)).float()
    tours = toured(to_the_end(symmetric(drawn)))
    assert torch.equal(tours.sort(dim=-1).values, torch.arange(n).expand(3, -1))


def test_a_round_joins_a_fragment_to_one_other_at_most() -> None:
    # Cities 0-1 and 2-3 are paths; both ends of one want an end of the other most.
    logits = torch.full((1, 4, 4), -NEVER)
    for i, j, logit in ((0, 2, 5.0), (1, 3, 4.0)):
        logits[0, i, j] = logits[0, j, i] = logit
    candidates = torch.arange(4).expand(1, 4, 4)
    pairs = joined(all_alone(torch.zeros(1, 4)), torch.tensor([[1, 0, 3, 2]]))
    assert mutual_best(pairs, candidates, logits).tolist() == [[2, -1, 0, -1]]
