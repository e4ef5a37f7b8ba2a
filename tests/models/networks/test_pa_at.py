"""PA-AT's decoder, against what the paper writes down."""

import torch

from models.data.preferences import fan_of_preferences
from models.networks.pa_at import AttentionDecoder
from models.networks.stepwise import Moment
from tests.helpers.small_actors import CPU


def test_pa_at_adds_the_preference_to_the_features_of_every_city() -> None:
    """Against the same decoder, fed with features to which the encoding was added by hand."""
    torch.manual_seed(0)
    decoder = AttentionDecoder(width=16, heads=4, clip=10.0)
    features = torch.randn(1, 7, 16)
    preferences = fan_of_preferences(3, CPU)
    recent = torch.tensor([[[2, 0, 7], [4, 3, 0], [6, 1, 7]]])
    moment = Moment(recent, torch.tensor([[0, 0, 1]]), torch.rand(1, 3, 7) < 0.4)
    moment.visited[..., 5] = False
    found = decoder.logits(decoder.remember(features), decoder.condition(preferences), moment)
    nothing = decoder.condition(torch.zeros(1, 2))._replace(
        context=torch.zeros(1, 16),
        ends=torch.zeros(1, 16),
        values=torch.zeros(1, 16),
        pointers=torch.zeros(1, 16),
    )
    for i, encoding in enumerate(decoder.encode_preference(preferences)):
        one = Moment(*(part[:, i : i + 1] for part in moment))
        expected = decoder.logits(decoder.remember(features + encoding), nothing, one)
        assert torch.allclose(found[:, i : i + 1], expected, atol=1e-5)
