"""PA-One for matrices of costs, which need not be symmetric: it builds tours city by city.

The encoder's heads attend less the more a step costs, in either direction; the decoder's pointers
fall off with the cost under the weights of a preference. An instance is encoded once for each
group of neighbouring preferences.
"""

from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from models.data.preferences import Groups, grouped, turned_outwards, weights
from models.networks.actor import Architecture, StepwiseActor
from models.networks.layers import FadingLayer, Seeing, feedforward, seeing_at_once
from models.networks.matrix_features import (
    LANDMARKS,
    initial_features,
    landmark_costs,
    spacing,
    unit_matrices,
)
from models.networks.stepwise import Decoder, Moment, glimpse_of, keys_values_pointers, look_up

# How fast each kind of head fades at first: with the first cost, the second, their weighted sum,
# of the steps from the city, and of those to it.
_FIRST_RATES = (
    (2.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (0.0, 2.0, 0.0, 0.0, 0.0, 0.0),
    (0.0, 0.0, 3.0, 0.0, 0.0, 0.0),
    (0.0, 0.0, 0.0, 0.0, 0.0, 3.0),
)

# Of log(1 + distance) under the weights, in plane 1, in plane 2.
_FIRST_SLOPES = torch.tensor([4.0, 0.0, 0.0])


class OneMemory(NamedTuple):
    """Tables of PA-One for matrices, those of features for each group of preferences anew.

    Axis bg is instances and groups, groups inner. Distances are 1 + sqrt(n) times those in each
    plane.
    """

    near_keys: Float[Tensor, "bg h/2 e n"]
    near_values: Float[Tensor, "bg h/2 n e"]
    far_keys: Float[Tensor, "bg h/2 e n"]
    far_values: Float[Tensor, "bg h/2 n e"]
    pointers: Float[Tensor, "bg d n"]
    current: Float[Tensor, "bg n d"]
    first: Float[Tensor, "bg n d"]
    distances: Float[Tensor, "b n n"]
    other_distances: Float[Tensor, "b n n"]
    log_distances: Float[Tensor, "b n n"]
    other_log_distances: Float[Tensor, "b n n"]


class OneConditioning(NamedTuple):
    """The effect of a preference on the rows of PA-One for matrices."""

    scale: Float[Tensor, "r d"]
    shift: Float[Tensor, "r d"]
    weights: Float[Tensor, "r 2"]
    slopes: Float[Tensor, "r 3"]


class MatrixEncoder(nn.Module):
    """The encoder: layers over costs in sum and to the landmarks, and the weights.

    Axis bg is instances and groups of preferences, groups inner.
    """

    seeing: Seeing

    def __init__(self, width: int, heads: int, layers: int, hidden: int) -> None:
        super().__init__()
        inputs = 2 * 6 + 4 * LANDMARKS
        self.embed = nn.Linear(2 * inputs + 2, width)
        self.layers = nn.ModuleList(
            FadingLayer(width, heads, hidden, _FIRST_RATES) for _ in range(layers)
        )
        self.norm = nn.LayerNorm(width)
        self.seeing = seeing_at_once

    def forward(
        self,
        matrices: Float[Tensor, "b 2 n n"],
        unit: Float[Tensor, "b 1 1 1"],
        weights: Float[Tensor, "g 2"],
    ) -> Float[Tensor, "bg n d"]:
        """Return the features of the cities for each of the weights; costs count in the unit."""
        sums = initial_features(matrices)
        landmarks = landmark_costs(matrices).unflatten(-1, (-1, 2)).mT  # (b, n, 2, 2 l)
        inputs = torch.cat((sums, landmarks), dim=-1).repeat_interleave(len(weights), dim=0)
        spread = weights.repeat(len(matrices), 1)[:, None].expand(-1, matrices.shape[-1], -1)
        weighted = inputs * spread[..., None]
        inputs = torch.cat((inputs.flatten(2), weighted.flatten(2), spread), dim=-1)
        features: Tensor = self.embed(inputs)
        costs = matrices / unit
        see = self.seeing(torch.stack((costs, costs.mT), dim=1), weights)
        for layer in self.layers:
            features = layer(features, see)
        normalised: Tensor = self.norm(features)
        return normalised


class OneDecoder(Decoder):
    """The decoder: queries modulated by the preference, pointers that fall off with cost.

    Its logits start as those of the nearest neighbour under the preference's weights, softened:
    minus a multiple of log(1 + distance); the pointer learns the rest. Half of the heads see the
    cities that are left through the same fall-off, the other half see them all alike. Tours
    start at a city that is given. The rows of an instance are its groups of preferences in turn,
    all of one size.
    """

    chooses_first = False

    def __init__(self, width: int, heads: int, clip: float) -> None:
        super().__init__()
        self.heads, self.clip = heads, clip
        last = nn.Linear(width, 2 * width + 3)
        self.encode_preference = nn.Sequential(nn.Linear(2, width), nn.ReLU(), last)
        self.project_ends = nn.Linear(width, 2 * width, bias=False)
        self.project_city = nn.Linear(width, 3 * width, bias=False)
        self.merge = nn.Linear(width, width, bias=False)
        self.norm = nn.LayerNorm(width)
        self.think = feedforward(width, width, hidden=width)
        nn.init.normal_(last.weight, std=0.02)
        with torch.no_grad():
            self.project_city.weight[-width:] *= 0.1  # so that pointers begin near zero
            last.bias.copy_(torch.cat((torch.ones(width), torch.zeros(width), _FIRST_SLOPES)))

    def remember(
        self,
        features: Float[Tensor, "bg n d"],
        distances: Float[Tensor, "b 2 n n"],
    ) -> OneMemory:
        """Compute the tables of the instances."""
        keys, values, pointers = keys_values_pointers(self.project_city(features), self.heads)
        (near_keys, far_keys), (near_values, far_values) = keys.chunk(2, 1), values.chunk(2, 1)
        return OneMemory(
            near_keys,
            near_values,
            far_keys,
            far_values,
            pointers,
            *self.project_ends(features).chunk(2, dim=-1),
            *(1 + distances).unbind(1),
            *distances.log1p().unbind(1),
        )

    def condition(self, preferences: Float[Tensor, "k 2"]) -> OneConditioning:
        """Return the part of each preference in the rows."""
        width = self.merge.in_features
        encoding = self.encode_preference(preferences)
        scale, shift, slopes = encoding.split((width, width, 3), dim=-1)
        return OneConditioning(scale, shift, weights(preferences), slopes)

    def logits(
        self, memory: OneMemory, rows: OneConditioning, moment: Moment
    ) -> Float[Tensor, "b r n"]:
        """Return unnormalised log-probabilities of the next city; minus infinity where visited."""
        b, r, _ = moment.visited.shape
        by_group = (len(memory.pointers), -1)  # the leading shape of what is looked up by group
        current, first = moment.current.view(by_group), moment.first.view(by_group)
        ends = look_up(memory.current, current) + look_up(memory.first, first)
        query = (rows.scale * ends.view(b, r, -1) + rows.shift).view_as(ends)
        mask = torch.zeros_like(moment.visited, dtype=query.dtype)
        mask = mask.masked_fill(moment.visited, -torch.inf)
        fall = (_cost_logits(memory, rows, moment.current) + mask).view(*current.shape, -1)
        near, far = query.chunk(2, dim=-1)
        glimpses = (
            # No gradient through the fall-off here: the logits below teach it.
            glimpse_of(near, memory.near_keys, memory.near_values, fall.detach()),
            glimpse_of(far, memory.far_keys, memory.far_values, mask.view_as(fall)),
        )
        glimpse = query + self.merge(torch.cat(glimpses, dim=-1))
        glimpse = glimpse + self.think(self.norm(glimpse))
        return (self.clip * torch.tanh(glimpse @ memory.pointers) + fall).view_as(mask)


def _cost_logits(
    memory: OneMemory, rows: OneConditioning, current: Int[Tensor, "b r"]
) -> Float[Tensor, "b r n"]:
    """Return the part of the logits that falls with the cost of the step to each city."""
    first, second, log_first, log_second = (
        look_up(table, current)
        for table in (
            memory.distances,
            memory.other_distances,
            memory.log_distances,
            memory.other_log_distances,
        )
    )
    # The weights add to 1, and so does what was added to the distances.
    weighted = torch.log(rows.weights[:, :1] * first + rows.weights[:, 1:] * second)
    slope, slope_first, slope_second = (-rows.slopes).split(1, dim=-1)  # (r, 1)
    return slope * weighted + slope_first * log_first + slope_second * log_second


class OneMatrixActor(StepwiseActor):
    """PA-One for matrices."""

    reads = "matrices"
    groups = 5
    encoder: MatrixEncoder
    decoder: OneDecoder

    def __init__(self, config: Architecture) -> None:
        super().__init__()
        self.encoder = MatrixEncoder(config.width, config.heads, config.layers, config.feedforward)
        self.decoder = OneDecoder(config.width, config.heads, config.clip)

    def grouped(self, preferences: Float[Tensor, "k 2"]) -> Groups:
        """Lay the preferences out as rows, turned so that the tours point along them."""
        return grouped(turned_outwards(preferences), self.groups)

    def remember(
        self, instances: Float[Tensor, "b 2 n n"], preferences: Float[Tensor, "r 2"]
    ) -> OneMemory:
        """Compute what decoding needs of the instances, once for each group of preferences."""
        scaled = unit_matrices(instances)
        unit = spacing(scaled)
        features = self.encoder(scaled, unit, self._weights(preferences))
        return self.decoder.remember(features, scaled / unit)

    def _weights(self, rows: Float[Tensor, "r 2"]) -> Float[Tensor, "g 2"]:
        """Return the weights in the middle of each group of rows."""
        return weights(rows.unflatten(0, (self.groups, -1)).mean(dim=1))
