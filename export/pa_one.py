"""One ONNX graph from PA-One: loops over blocks of preferences, over rounds, over cities.

The parts are exported each on its own and put together by the text below. A block has as many
preferences as there is room for their costs. It begins with a round of all cities; further rounds
work on the ends that are still open, of which there are fewer each time. The last loop goes along
the links of the finished tours.
"""

import onnx
import torch
from onnx import ModelProto, parser
from torch import Tensor, nn
from torch.export import Dim

from export.onnx_parts import as_function, exported, inlined
from models.data.preferences import turned_outwards, weights
from models.networks.candidates import (
    CANDIDATES,
    cheapest_candidates,
    first_candidates,
    padded_distances,
    single_cities,
    weighted_costs,
)
from models.networks.fragments import Fragments, cleared, first_steps, next_city
from models.networks.pa_one import OneActor

_ROOM = 10_000_000  # costs of a block, 40 MB; a round takes a few times as much

_ACTOR = """
<ir_version: 10, opset_import: ["": %(opset)d, "paretour": 1]>
actor (float[n, 4] cities, float[k, 2] preferences) => (int64[k, n] tours)
{
    zero = Constant <value_ints = [0]> ()
    one = Constant <value_ints = [1]> ()
    two = Constant <value_ints = [2]> ()
    room = Constant <value_ints = [%(room)d]> ()
    n = Shape <start = 0, end = 1> (cities)
    k = Shape <start = 0, end = 1> (preferences)
    cities_in_all = Squeeze (n)
    steps_in_all = Sub (n, two)
    steps = Squeeze (steps_in_all)
    squared = Mul (n, n)
    fitting = Div (room, squared)
    one_at_least = Max (fitting, one)
    size = Min (one_at_least, k)
    more = Add (k, size)
    filled = Sub (more, one)
    blocks_in_all = Div (filled, size)
    blocks = Squeeze (blocks_in_all)
    shape_of_nothing = Concat <axis = 0> (zero, n)
    nothing = ConstantOfShape <value = int64[1] {0}> (shape_of_nothing)
    distances, weights = paretour.Prepare (cities, preferences)

    tours = Loop (blocks, , nothing) <body = add_block
        (int64 block, bool before, int64[done, n] so_far) => (bool after, int64[grown, n] longer)
        {
            after = Identity (before)
            first_row = Mul (block, size)
            beyond_row = Add (first_row, size)
            rows = Slice (weights, first_row, beyond_row, zero)
            costs, ends, partners, open, links, left, kept, unfinished =
                paretour.Begin (distances, rows)

            last_ends, last_partners, last_open, last_links, last_left, last_kept = Loop
                (cities_in_all, unfinished, ends, partners, open, links, left, kept) <body = join
                (int64 round, bool going_on, int64[r, e] all_ends, int64[r, e] all_partners,
                 bool[r, e] all_open, int64[r, l] links_in, int64[r] left_in, int64[1] kept_in)
                => (bool go_on, int64[r, f] ends_out, int64[r, f] partners_out,
                    bool[r, f] open_out, int64[r, l] links_out, int64[r] left_out,
                    int64[1] kept_out)
                {
                    ends_in = Slice (all_ends, zero, kept_in, one)
                    partners_in = Slice (all_partners, zero, kept_in, one)
                    open_in = Slice (all_open, zero, kept_in, one)
                    ends_out, partners_out, open_out, links_out, left_out, kept_out, go_on =
                        paretour.Round (costs, ends_in, partners_in, open_in, links_in, left_in)
                }>

            first, second = paretour.Start
                (last_ends, last_partners, last_open, last_links, last_left)
            last_before, last_now, others = Loop (steps, , first, second) <body = walk
                (int64 step, bool walking_on, int64[r] city_before, int64[r] city_now)
                => (bool walk_on, int64[r] new_before, int64[r] new_now, int64[r] visited)
                {
                    walk_on = Identity (walking_on)
                    new_before = Identity (city_now)
                    new_now = paretour.Next (last_links, city_before, city_now)
                    visited = Identity (new_now)
                }>
            first_of_all = Unsqueeze (first, zero)
            second_of_all = Unsqueeze (second, zero)
            by_step = Concat <axis = 0> (first_of_all, second_of_all, others)
            found = Transpose <perm = [1, 0]> (by_step)
            longer = Concat <axis = 0> (so_far, found)
        }>
}
"""


class _Prepare(nn.Module):
    """The distances, and the weights of each preference."""

    def forward(self, cities: Tensor, preferences: Tensor) -> tuple[Tensor, Tensor]:
        return padded_distances(cities), weights(turned_outwards(preferences))


class _Begin(nn.Module):
    """The costs of the rows, and their fragments after a first round."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, distances: Tensor, rows: Tensor) -> tuple[Tensor, ...]:
        costs = weighted_costs(distances, rows)
        fragments = self.actor.round(costs, single_cities(costs), first_candidates(costs))
        return costs, *_left(fragments)


class _Round(nn.Module):
    """The fragments after one more round."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, costs: Tensor, given: tuple[Tensor, ...]) -> tuple[Tensor, ...]:
        fragments = Fragments(*given)
        return _left(self.actor.round(costs, fragments, cheapest_candidates(costs, fragments)))


def _left(fragments: Fragments) -> tuple[Tensor, ...]:
    """Return the cleared fragments, how many ends to keep, and whether more are to be joined."""
    after, kept = cleared(fragments)
    return *after, kept[None], (after.left > 1).any()


class _Start(nn.Module):
    """The first two cities of each finished tour."""

    def forward(self, fragments: tuple[Tensor, ...]) -> tuple[Tensor, Tensor]:
        return first_steps(Fragments(*fragments))


class _Next(nn.Module):
    """The next city of each finished tour."""

    def forward(self, links: Tensor, before: Tensor, now: Tensor) -> Tensor:
        return next_city(links, before, now)


# Sizes to trace at, all different, and different from all that is fixed: cities, rows, ends.
_N, _R, _E = 17, 37, 13
_CITIES = Dim("n", min=2)
_AXES = {
    _N: _CITIES,
    _N + CANDIDATES: _CITIES + CANDIDATES,
    2 * _N + 1: 2 * _CITIES + 1,
    _R: Dim("r", min=1),
    _E: Dim("e", min=2),
}
_FRAGMENTS = ("ends", "partners", "open", "links", "left")


def to_onnx(actor: OneActor) -> ModelProto:
    """Return the actor as one graph: cities (n, 4) and preferences (k, 2) to tours (k, n)."""
    cities, rows = torch.rand(_N, 4), torch.rand(_R, 2)
    distances = padded_distances(cities)
    costs = weighted_costs(distances, rows)
    whole = single_cities(costs)
    ends, partners, open_ = (part[:, :_E].contiguous() for part in whole[:3])
    some = Fragments(ends, partners, open_, whole.links, whole.left)
    left = [*(f"new_{name}" for name in _FRAGMENTS), "kept", "go_on"]
    parts = {
        "Prepare": (_Prepare(), (cities, rows), ["cities", "preferences"], ["distances", "rows"]),
        "Begin": (_Begin(actor), (distances, rows), ["distances", "rows"], ["costs", *left]),
        "Round": (
            _Round(actor),
            (costs, tuple(some)),
            ["costs", *_FRAGMENTS],
            left,
        ),
        "Start": (_Start(), (tuple(some),), list(_FRAGMENTS), ["first", "second"]),
        "Next": (
            _Next(),
            (some.links, *first_steps(some)),
            ["links", "before", "now"],
            ["next"],
        ),
    }
    functions = []
    for name, part in parts.items():
        graph = exported(*part, _AXES)
        opset = next(used.version for used in graph.opset_import if not used.domain)
        functions.append(as_function(name, graph))
    model = parser.parse_model(_ACTOR % {"opset": opset, "room": _ROOM})
    model = inlined(model, functions)
    onnx.checker.check_model(model, full_check=True)
    return model
