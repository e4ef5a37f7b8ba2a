"""PA-EAN's decoder, against what its paper writes down."""

import torch
from torch import Tensor

from models.data.sampling import fan_of_preferences
from models.networks.additive_attention import exponential, pointed
from models.networks.pa_ean import EANDecoder
from models.networks.stepwise import Moment

CPU = torch.device("cpu")


def as_written(decoder: EANDecoder, features: Tensor, recent: list[int]) -> Tensor:
    """The scores of all cities of one instance, cities by their features, from the formulas."""
    queries = decoder.project_past.weight.chunk(3)
    query = sum(
        (w @ features[city] for w, city in zip(queries, recent, strict=False)), torch.zeros(1)
    )
    pointing = decoder.project_query.weight @ query.relu().expand(decoder.project_query.in_features)
    reference = features @ decoder.project_city.weight.T
    return decoder.clip * torch.tanh(torch.tanh(reference + pointing) @ decoder.judge)


def test_the_decoder_points_as_its_paper_writes() -> None:
    """With the encoding of a preference added by hand to the features of every city."""
    torch.manual_seed(0)
    decoder = EANDecoder(width=16, clip=10.0)
    features, preferences = torch.randn(7, 16), fan_of_preferences(4, CPU)
    pasts = [[2, 5, 1], [4], [], [6, 0]]  # of each row, the latest city first
    visited = torch.tensor([[city in past for city in range(7)] for past in pasts])
    recent = torch.tensor([(past + [7] * 3)[:3] for past in pasts])
    moment = Moment(recent[None], recent[None, :, 0], visited[None])
    found = decoder.logits(decoder.remember(features[None]), decoder.condition(preferences), moment)
    for i, encoding in enumerate(decoder.encode_preference(preferences)):
        expected = as_written(decoder, features + encoding, pasts[i])
        assert torch.allclose(found[0, i, ~visited[i]], expected[~visited[i]], atol=1e-5)
        assert (found[0, i, visited[i]] == -torch.inf).all()


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
