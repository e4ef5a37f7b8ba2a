"""One ONNX graph from PA-One: its parts, exported each on its own and put into the graph's text."""

import onnx
import torch
from onnx import ModelProto, parser
from torch import Tensor, nn

from export import pa_one_lists
from export.onnx_parts import OPSET, Part, as_function, inlined, traced
from export.pa_one_graph import COORDINATES, MATRICES, Names, graph
from export.repairs import as_problem, as_tensors, first_ends, left_of, present, repair_parts
from models.data.preferences import turned_outwards, weights
from models.networks.joining.candidates import cheapest_candidates, first_candidates, single_cities
from models.networks.joining.costs import CANDIDATES, Costs, Problem
from models.networks.joining.fragments import Fragments, first_steps, next_city
from models.networks.pa_one import OneActor
from models.networks.pa_one_matrix import OneMatrixActor
from models.rollout_repairs import CITIES, NEAR, least_costs

_ROOM = 10_000_000  # costs of a block, 40 MB; a round takes a few times as much


class _Prepare(nn.Module):
    """The costs in each objective, and the weights of each preference."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, instance: Tensor, preferences: Tensor) -> tuple[Tensor, ...]:
        return as_tensors(self.actor.problem(instance, weights(turned_outwards(preferences))))


class _Begin(nn.Module):
    """The costs of the rows, the least for each city, and the fragments after a first round."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, given: tuple[Tensor, ...]) -> tuple[Tensor, ...]:
        costs = as_problem(given).tables
        candidates = first_candidates(costs)
        fragments = self.actor.round(costs, single_cities(costs), candidates, self.actor.joinings)
        return *present(costs), least_costs(candidates), *left_of(fragments, 1)


class _Round(nn.Module):
    """The fragments after one more round."""

    def __init__(self, actor: OneActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, tables: tuple[Tensor, ...], given: tuple[Tensor, ...]) -> tuple[Tensor, ...]:
        costs, fragments = Costs(*tables), Fragments(*given)
        candidates = cheapest_candidates(costs, fragments)
        after = self.actor.round(costs, fragments, candidates, self.actor.joinings)
        return left_of(after, 1)


class _Start(nn.Module):
    """The first two cities of each finished tour."""

    def forward(self, given: tuple[Tensor, ...]) -> tuple[Tensor, Tensor]:
        return first_steps(Fragments(*given))


class _Next(nn.Module):
    """The next city of each finished tour."""

    def forward(self, links: Tensor, before: Tensor, now: Tensor) -> Tensor:
        return next_city(links, before, now)


# Sizes to trace at, all different, and different from all that is fixed: cities, rows, ends, those
# of a contracted problem, cities to choose from in a repair, and cut cities. Three columns of a
# repair's problem belong to each of the last.
_N, _R, _E, _F, _L, _M = 17, 37, 13, 15, 11, 7
_AXES = {
    *(_N, _N + CANDIDATES, 2 * _N + 1, _R, _E),
    *(_F, _F + CANDIDATES, 2 * _F + 1),
    *(_L, _M, 3 * _M, 3 * _M + CANDIDATES, 6 * _M + 1),
}


def to_onnx(actor: OneActor) -> ModelProto:
    """Return the actor as one graph: an instance, preferences (k, 2), repairs () to tours (k, n).

    The instance is cities (n, 4) or matrices (2, n, n), as the actor reads it. A second output,
    visited (k, n), has for each preference another tour that repairs visited.
    """
    names = MATRICES if isinstance(actor, OneMatrixActor) else COORDINATES
    functions = [
        as_function(name, traced(*part, _AXES), part[2])
        for name, part in _parts(actor, names).items()
    ]
    room = _ROOM // len(names.tables)
    model = inlined(parser.parse_model(graph(names, OPSET, room, (NEAR, CITIES))), functions)
    onnx.checker.check_model(model, full_check=True)
    return model


def _parts(actor: OneActor, names: Names) -> dict[str, Part]:
    """Return the functions that the text calls, by name."""
    instance = torch.rand(2, _N, _N) if names is MATRICES else torch.rand(_N, 4)
    preferences = torch.rand(_R, 2)
    with torch.no_grad():
        problem = actor.problem(instance, weights(preferences))
    some = first_ends(single_cities(problem.tables), _E)
    if isinstance(actor, OneMatrixActor):
        more = first_ends(single_cities(problem.tables), _F)
        more = more._replace(left=torch.full_like(more.left, _F))  # the other cities are nowhere
        building = pa_one_lists.parts(actor, names, (instance, preferences), (problem, some, more))
    else:
        building = _parts_of_all_pairs(actor, names, (instance, preferences), (problem, some))
    ring = some._replace(links=some.links.clamp(min=0))  # any cities
    return {
        **building,
        "Next": (_Next(), (ring.links, *first_steps(ring)), ["links", "before", "now"], ["next"]),
        **repair_parts(actor, names, problem, (_L, _M), _E),
    }


def _parts_of_all_pairs(
    actor: OneActor, names: Names, given: tuple[Tensor, Tensor], state: tuple[Problem, Fragments]
) -> dict[str, Part]:
    """Return the parts that build tours, by name, where candidates are among all open ends."""
    problem, some = state
    after, fragments = names.after_round, list(names.fragments)
    return {
        "Prepare": (
            _Prepare(actor),
            given,
            [names.instance, "preferences"],
            list(names.problem),
        ),
        "Begin": (
            _Begin(actor),
            (as_tensors(problem),),
            list(names.problem),
            [*names.costs, "least", *after],
        ),
        "Round": (
            _Round(actor),
            (present(problem.tables), present(some)),
            [*names.costs, *fragments],
            after,
        ),
        "Start": (_Start(), (present(some),), fragments, ["first", "second"]),
    }
