"""Additive attention and its gradients."""

import torch

from models.networks.additive_attention import exponential, pointed


def test_scores_and_their_gradients_are_those_of_the_tangent() -> None:
    generator = torch.Generator().manual_seed(1)
    shapes = ((2, 5, 12), (2, 9, 12), (12,))
    x, y, v = (torch.randn(s, generator=generator).requires_grad_() for s in shapes)
    visited = torch.rand(2, 9, 5, generator=generator) < 0.4
    incoming = torch.randn(2, 9, 5, generator=generator)

    found = pointed(exponential(x), exponential(y), v, visited)
    expected = torch.tanh(x[:, None] + y[:, :, None]) @ v
    assert torch.allclose(found[~visited], expected[~visited], atol=1e-5)
    ours, theirs = (
        torch.autograd.grad((scores * incoming)[~visited].sum(), (x, y, v))
        for scores in (found, expected)
    )
    for our, their in zip(ours, theirs, strict=True):
        assert torch.allclose(our, their, atol=1e-4)


def test_scores_stay_finite_where_projections_are_huge() -> None:
    x, y = torch.tensor([[[-300.0], [300.0]]]), torch.tensor([[[-300.0], [300.0]]])
    nothing = torch.zeros(1, 2, 2, dtype=torch.bool)
    scores = pointed(exponential(x), exponential(y), torch.ones(1), nothing)
    assert torch.allclose(scores, torch.tensor([[[-1.0, 0.0], [0.0, 1.0]]]))
