"""One ONNX graph from PA-One: its parts, exported each on its own and put into the graph's text."""

import onnx
import torch
from onnx import ModelProto, parser

from export import pa_one_lists
from export.onnx_parts import OPSET, Part, as_function, inlined, traced
from export.pa_one_graph import GraphSizes, graph
from export.pa_one_names import COORDINATES, MATRICES, Names
from export.repairs import first_ends, repair_parts
from models.data.preferences import weights
from models.networks.joining.candidates import single_cities
from models.networks.joining.costs import CANDIDATES
from models.networks.pa_one import MANY, OneActor
from models.networks.pa_one_matrix import OneMatrixActor
from models.rollout_repairs import CITIES, NEAR

_ROOM = 3_000_000  # costs of a block, 12 MB; a round takes a few times as much

# Sizes to trace at, all different, and different from all that is fixed: cities, rows, ends, those
# of a contracted problem, cities to make lists of, cities on a list, cities to choose from in a
# repair, and cut cities. Three columns of a repair's problem belong to each of the last.
_N, _R, _E, _F, _B, _K, _L, _M = 17, 37, 13, 15, 14, 48, 11, 7
_AXES = {
    *(_N, _N + CANDIDATES, 2 * _N, 2 * _N + 1, _R, _E),
    *(_F, _F + CANDIDATES, 2 * _F + 1),
    *(_B, _K, _L, _M, 3 * _M, 3 * _M + CANDIDATES, 6 * _M + 1),
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
    sizes = GraphSizes(room, actor.list_sizes, MANY, NEAR, CITIES)
    model = inlined(parser.parse_model(graph(names, OPSET, sizes)), functions)
    onnx.checker.check_model(model, full_check=True)
    return model


def _parts(actor: OneActor, names: Names) -> dict[str, Part]:
    """Return the functions that the text calls, by name."""
    instance = torch.rand(2, _N, _N) if names is MATRICES else torch.rand(_N, 4)
    preferences = torch.rand(_R, 2)
    with torch.no_grad():
        problem = actor.problem(instance, weights(preferences))
    alone = single_cities(problem.tables)
    some, more = (first_ends(alone, count) for count in (_E, _F))
    more = more._replace(left=torch.full_like(more.left, _F))  # the other cities are nowhere
    given, listed = (instance, preferences), (torch.arange(_B), torch.zeros(_K))
    return {
        **pa_one_lists.parts(actor, names, given, listed, (problem, some, more)),
        **repair_parts(actor, names, problem, (_L, _M), _E),
    }
