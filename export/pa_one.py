"""One ONNX graph from PA-One: its parts, exported each on its own and put into the graph's text."""

import onnx
import torch
from onnx import ModelProto, parser
from torch import Tensor, nn
from torch.export import Dim

from export.onnx_parts import Part, as_function, exported, inlined
from export.pa_one_graph import AFTER_ROUND, FRAGMENTS, GRAPH
from export.repairs import Rejoin, first_ends, repair_parts
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
from models.rollout_repairs import CITIES, least_costs

_ROOM = 10_000_000  # costs of a block, 40 MB; a round takes a few times as much


class _Prepare(nn.Module):
    """The distances, and the weights of each preference."""

    def forward(self, cities: Tensor, preferences: Tensor) -> tuple[Tensor, Tensor]:
        return padded_distances(cities), weights(turned_outwards(preferences))


class _Begin(nn.Module):
    """The costs of the rows, the least for each city, and the fragments after a first round."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, distances: Tensor, rows: Tensor) -> tuple[Tensor, ...]:
        costs = weighted_costs(distances, rows)
        candidates = first_candidates(costs)
        fragments = self.actor.round(costs, single_cities(costs), candidates)
        return costs, least_costs(candidates), *_left(fragments)


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


# Sizes to trace at, all different, and different from all that is fixed: cities, rows, ends, cut
# cities. Three columns of a repair's problem belong to each of the last.
_N, _R, _E, _M = 17, 37, 13, 7
_ALL, _CUT = Dim("n", min=2), Dim("m", min=2)
_AXES = {
    _N: _ALL,
    _N + CANDIDATES: _ALL + CANDIDATES,
    2 * _N + 1: 2 * _ALL + 1,
    _R: Dim("r", min=1),
    _E: Dim("e", min=2),
    _M: _CUT,
    3 * _M: 3 * _CUT,
    3 * _M + CANDIDATES: 3 * _CUT + CANDIDATES,
    6 * _M + 1: 6 * _CUT + 1,
}


def to_onnx(actor: OneActor) -> ModelProto:
    """Return the actor as one graph: cities (n, 4), preferences (k, 2), repairs () to tours (k, n).

    A second output, visited (k, n), has for each preference another tour that repairs visited.
    """
    functions = []
    for name, part in _parts(actor).items():
        graph = exported(*part, _AXES)
        opset = next(used.version for used in graph.opset_import if not used.domain)
        functions.append(as_function(name, graph))
    model = parser.parse_model(GRAPH % {"opset": opset, "room": _ROOM, "cities_cut": CITIES})
    model = inlined(model, functions)
    onnx.checker.check_model(model, full_check=True)
    return model


def _parts(actor: OneActor) -> dict[str, Part]:
    """Return the functions that the text calls, by name."""
    cities, rows = torch.rand(_N, 4), torch.rand(_R, 2)
    distances = padded_distances(cities)
    costs = weighted_costs(distances, rows)
    some = first_ends(single_cities(costs), _E)
    after, given = list(AFTER_ROUND), ["costs", *FRAGMENTS]
    return {
        "Prepare": (_Prepare(), (cities, rows), ["cities", "preferences"], ["distances", "rows"]),
        "Begin": (
            _Begin(actor),
            (distances, rows),
            ["distances", "rows"],
            ["costs", "least", *after],
        ),
        "Round": (_Round(actor), (costs, tuple(some)), given, after),
        "Start": (_Start(), (tuple(some),), list(FRAGMENTS), ["first", "second"]),
        "Next": (_Next(), (some.links, *first_steps(some)), ["links", "before", "now"], ["next"]),
        "Rejoin": (Rejoin(actor), (costs, tuple(some)), given, after),
        **repair_parts(distances, rows, _M, _E),
    }
