"""PA-EAN's decoder, against what its paper writes down."""

import torch
from torch import Tensor

from models.data.preferences import fan_of_preferences
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
