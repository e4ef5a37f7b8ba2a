"""From features and preferences to the next city: the decoders of PA-AT and of PA-One for matrices.

Both share one key, value and pointer per city among all preferences, so that a decoding step for
k preferences is a few products of a (k, d) with a (d, n) matrix. A *row* is one tour under
construction, or one moment of it when finished tours are scored: the same method serves both.
"""

from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from models.lagrangian import weights
from models.networks.layers import feedforward, preference_encoder


class Moment(NamedTuple):
    """Where each row stands: its last three cities, the latest first; its first; all it has seen.

    Index n stands for a city that is not chosen yet.
    """

    recent: Int[Tensor, "b r 3"]
    first: Int[Tensor, "b r"]
    visited: Bool[Tensor, "b r n"]

    @property
    def current(self) -> Int[Tensor, "b r"]:
        """The city that each row is at."""
        return self.recent[..., 0]


class AttentionMemory(NamedTuple):
    """PA-AT's tables of the instances; the ends have one row more, for before the first choice.

    Here and below keys, values and pointers are scaled and laid out so that a step only
    multiplies; e is d / h.
    """

    keys: Float[Tensor, "b h e n"]
    values: Float[Tensor, "b h n e"]
    pointers: Float[Tensor, "b d n"]
    context: Float[Tensor, "b 1 d"]
    current: Float[Tensor, "b n+1 d"]
    first: Float[Tensor, "b n+1 d"]


class AttentionConditioning(NamedTuple):
    """What a preference adds to the projections of every city, and so to PA-AT's rows."""

    context: Float[Tensor, "r d"]
    ends: Float[Tensor, "r d"]
    values: Float[Tensor, "r d"]
    pointers: Float[Tensor, "r d"]


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
    """What a preference does to the rows of PA-One for matrices."""

    scale: Float[Tensor, "r d"]
    shift: Float[Tensor, "r d"]
    weights: Float[Tensor, "r 2"]
    slopes: Float[Tensor, "r 3"]


class AttentionDecoder(nn.Module):
    """Kool et al.'s decoder with the paper's preference encoder: one layer, added to the graph.

    Adding the encoding e of a preference to the features of every city adds W e to every key,
    value and pointer. The same addition to all keys leaves attention as it was; values and
    pointers get theirs after the products, so that the tables stay shared. The actor chooses
    the first city too, from a learned placeholder.
    """

    chooses_first = True

    def __init__(self, width: int, heads: int, clip: float, preference_layers: int = 1) -> None:
        super().__init__()
        self.heads, self.clip = heads, clip
        self.encode_preference = preference_encoder(width, preference_layers)
        self.placeholder = nn.Parameter(torch.empty(2, 1, 1, width).uniform_(-1, 1))
        self.project_context = nn.Linear(width, width, bias=False)
        self.project_ends = nn.Linear(width, 2 * width, bias=False)
        self.project_city = nn.Linear(width, 3 * width, bias=False)
        self.merge = nn.Linear(width, width, bias=False)

    def remember(self, features: Float[Tensor, "b n d"]) -> AttentionMemory:
        """The tables of the instances."""
        current, first = (
            torch.cat((table, opening.expand(len(table), -1, -1)), dim=1)
            for table, opening in zip(
                self.project_ends(features).chunk(2, dim=-1), self.placeholder, strict=True
            )
        )
        context = self.project_context(features.mean(dim=1, keepdim=True))
        views = _views(self.project_city(features), self.heads)
        return AttentionMemory(*views, context, current, first)

    def condition(self, preferences: Float[Tensor, "k 2"]) -> AttentionConditioning:
        """The rows of the preferences."""
        encoding = self.encode_preference(preferences)
        current, first = self.project_ends(encoding).chunk(2, dim=-1)
        _, values, pointers = self.project_city(encoding).chunk(3, dim=-1)
        pointers = pointers / pointers.shape[-1] ** 0.5
        context = self.project_context(encoding)
        return AttentionConditioning(context, current + first, values, pointers)

    def logits(
        self, memory: AttentionMemory, rows: AttentionConditioning, moment: Moment
    ) -> Float[Tensor, "b r n"]:
        """Unnormalised log-probabilities of the next city; minus infinity where visited."""
        begun = (moment.current < moment.visited.shape[-1])[..., None]
        ends = look_up(memory.current, moment.current) + look_up(memory.first, moment.first)
        query = memory.context + rows.context + ends + begun * rows.ends
        mask = torch.zeros_like(moment.visited, dtype=query.dtype)
        mask = mask.masked_fill(moment.visited, -torch.inf)
        glimpse = _glimpse(query, memory.keys, memory.values, mask)
        glimpse = self.merge(glimpse + rows.values)
        shift = (glimpse * rows.pointers).sum(-1, keepdim=True)
        return self.clip * torch.tanh(glimpse @ memory.pointers + shift) + mask


class OneDecoder(nn.Module):
    """PA-One for matrices: queries modulated by the preference, pointers that fall off with cost.

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
        """The tables of the instances."""
        keys, values, pointers = _views(self.project_city(features), self.heads)
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
        """The rows of the preferences."""
        width = self.merge.in_features
        encoding = self.encode_preference(preferences)
        scale, shift, slopes = encoding.split((width, width, 3), dim=-1)
        return OneConditioning(scale, shift, weights(preferences), slopes)

    def logits(
        self, memory: OneMemory, rows: OneConditioning, moment: Moment
    ) -> Float[Tensor, "b r n"]:
        """Unnormalised log-probabilities of the next city; minus infinity where visited."""
        b, r, _ = moment.visited.shape
        by_group = (len(memory.pointers), -1)  # the leading shape of what is looked up by group
        current, first = moment.current.view(by_group), moment.first.view(by_group)
        ends = look_up(memory.current, current) + look_up(memory.first, first)
        query = (rows.scale * ends.view(b, r, -1) + rows.shift).view_as(ends)
        mask = torch.zeros_like(moment.visited, dtype=query.dtype)
        mask = mask.masked_fill(moment.visited, -torch.inf)
        pull = (_pull(memory, rows, moment.current) + mask).view(*current.shape, -1)
        near, far = query.chunk(2, dim=-1)
        glimpses = (
            # No gradient through the pull here: the logits below teach it.
            _glimpse(near, memory.near_keys, memory.near_values, pull.detach()),
            _glimpse(far, memory.far_keys, memory.far_values, mask.view_as(pull)),
        )
        glimpse = query + self.merge(torch.cat(glimpses, dim=-1))
        glimpse = glimpse + self.think(self.norm(glimpse))
        return (self.clip * torch.tanh(glimpse @ memory.pointers) + pull).view_as(mask)


# exp(-80) is still a normal float32, and no share of a sum of float32 that begins with 1.
_NOTHING = 80.0

# Of log(1 + distance) under the weights, in plane 1, in plane 2.
_FIRST_SLOPES = torch.tensor([4.0, 0.0, 0.0])


def _pull(
    memory: OneMemory, rows: OneConditioning, current: Int[Tensor, "b r"]
) -> Float[Tensor, "b r n"]:
    """How much each city draws a row that stands at its current city: minus a cost."""
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


def _views(
    projected: Float[Tensor, "b n three_d"], heads: int
) -> tuple[Float[Tensor, "b h e n"], Float[Tensor, "b h n e"], Float[Tensor, "b d n"]]:
    """Keys, values and pointers from their projections."""
    keys, values, pointers = projected.chunk(3, dim=-1)
    width = keys.shape[-1]
    return (
        keys.unflatten(-1, (heads, -1)).permute(0, 2, 3, 1) * (heads / width) ** 0.5,
        values.unflatten(-1, (heads, -1)).transpose(1, 2),
        pointers.mT / width**0.5,
    )


def look_up(table: Float[Tensor, "b m d"], index: Int[Tensor, "b r"]) -> Float[Tensor, "b r d"]:
    """For each instance, the rows of its table that the index names."""
    b, m, d = table.shape
    flat = index + m * torch.arange(b, device=index.device)[:, None]
    return table.reshape(-1, d).index_select(0, flat.flatten()).view(b, -1, d)


def _glimpse(
    query: Float[Tensor, "b r d"],
    keys: Float[Tensor, "b h e n"],
    values: Float[Tensor, "b h n e"],
    mask: Float[Tensor, "b r n"],
) -> Float[Tensor, "b r d"]:
    """Multi-head attention of rows to cities; the mask is added to the scores."""
    heads = query.unflatten(-1, (keys.shape[1], -1)).transpose(1, 2)
    scores = heads @ keys + mask[:, None]
    if torch.compiler.is_exporting():
        # ONNX Runtime's exponential of minus infinity is a subnormal number, with which a
        # processor is some fourteen times slower; this far below the largest is as good as nothing.
        scores = torch.maximum(scores, scores.amax(dim=-1, keepdim=True) - _NOTHING)
    seen = scores.softmax(dim=-1) @ values
    return seen.transpose(1, 2).flatten(2)
