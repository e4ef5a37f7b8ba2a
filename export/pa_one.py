"""One ONNX graph from PA-One: its parts, exported each on its own and put into the graph's text."""

import onnx
import torch
from onnx import ModelProto, parser
from torch import Tensor, nn
from torch.export import Dim

from export.onnx_parts import Part, as_function, exported, inlined
from export.pa_one_graph import COORDINATES, MATRICES, Names, graph
from export.repairs import Rejoin, as_problem, first_ends, present, repair_parts
from models.data.preferences import turned_outwards, weights
from models.networks.candidates import (
    CANDIDATES,
    Costs,
    cheaper_starts,
    cheapest_candidates,
    first_candidates,
    single_cities,
    weighted_costs,
)
from models.networks.fragments import Fragments, cleared, first_steps, next_city
from models.networks.pa_one import OneActor
from models.rollout_repairs import CITIES, least_costs

_ROOM = 10_000_000  # costs of a block, 40 MB; a round takes a few times as much


class _Prepare(nn.Module):
    """The costs in each objective, the weights of each preference, and its prices."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, instance: Tensor, preferences: Tensor) -> tuple[Tensor, ...]:
        costs, rows = self.actor.costs(instance), weights(turned_outwards(preferences))
        return *present(costs), rows, *(self.actor.prices(costs, rows) or ())


class _Begin(nn.Module):
    """The costs of the rows, the least for each city, and the fragments after a first round."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, given: tuple[Tensor, ...]) -> tuple[Tensor, ...]:
        costs = weighted_costs(*as_problem(given))
        candidates = first_candidates(costs)
        fragments = self.actor.round(costs, single_cities(costs), candidates, self.actor.joinings)
        return *present(costs), least_costs(candidates), *_left(fragments)


class _Round(nn.Module):
    """The fragments after one more round."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, tables: tuple[Tensor, ...], given: tuple[Tensor, ...]) -> tuple[Tensor, ...]:
        costs, fragments = Costs(*tables), Fragments(*given)
        candidates = cheapest_candidates(costs, fragments)
        return _left(self.actor.round(costs, fragments, candidates, self.actor.joinings))


def _left(fragments: Fragments) -> tuple[Tensor, ...]:
    """Return the cleared fragments, how many ends to keep, and whether more are to be joined."""
    after, kept = cleared(fragments)
    return *present(after), kept[None], (after.left > 1).any()


class _Start(nn.Module):
    """The first two cities of each finished tour.

    Where costs have directions, two tables of them come before the fragments.
    """

    def __init__(self, *, has_directions: bool) -> None:
        super().__init__()
        self.tables = 2 * has_directions

    def forward(self, given: tuple[Tensor, ...]) -> tuple[Tensor, Tensor]:
        fragments = Fragments(*given[self.tables :])
        if not self.tables:
            return first_steps(fragments)
        return first_steps(fragments, cheaper_starts(Costs(*given[: self.tables]), fragments))


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
    """Return the actor as one graph: an instance, preferences (k, 2), repairs () to tours (k, n).

    The instance is cities (n, 4) or matrices (2, n, n), as the actor reads it. A second output,
    visited (k, n), has for each preference another tour that repairs visited.
    """
    names = MATRICES if actor.reads == "matrices" else COORDINATES
    functions = []
    for name, part in _parts(actor, names).items():
        model = exported(*part, _AXES)
        opset = next(used.version for used in model.opset_import if not used.domain)
        functions.append(as_function(name, model))
    room = _ROOM // len(names.tables)
    model = inlined(parser.parse_model(graph(names, opset, room, CITIES)), functions)
    onnx.checker.check_model(model, full_check=True)
    return model


def _parts(actor: OneActor, names: Names) -> dict[str, Part]:
    """Return the functions that the text calls, by name."""
    instance = torch.rand(2, _N, _N) if names is MATRICES else torch.rand(_N, 4)
    rows = torch.rand(_R, 2)
    with torch.no_grad():
        tables, prices = actor.costs(instance), actor.prices(actor.costs(instance), rows)
    costs = weighted_costs(tables, rows, prices)
    some = first_ends(single_cities(costs), _E)
    after, given = names.after_round, [*names.costs, *names.fragments]
    joining = (present(costs), present(some))
    problem = *present(tables), rows, *(prices or ())
    finished = (*present(costs), *present(some)) if names.prices else present(some)
    return {
        "Prepare": (
            _Prepare(actor),
            (instance, rows.clone()),
            [names.instance, "preferences"],
            list(names.problem),
        ),
        "Begin": (
            _Begin(actor),
            (problem,),
            list(names.problem),
            [*names.costs, "least", *after],
        ),
        "Round": (_Round(actor), joining, given, after),
        "Start": (
            _Start(has_directions=actor.has_directions),
            (finished,),
            list(names.finished),
            ["first", "second"],
        ),
        "Next": (_Next(), (some.links, *first_steps(some)), ["links", "before", "now"], ["next"]),
        "Rejoin": (Rejoin(actor), joining, given, after),
        **repair_parts(names, problem, _M, _E),
    }
