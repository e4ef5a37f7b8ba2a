"""One ONNX graph from PA-One: its parts, exported each on its own and put into the graph's text."""

from typing import NamedTuple

import onnx
import torch
from onnx import ModelProto, parser
from torch import Tensor

from export import pa_one_lists, pa_one_two
from export.onnx_parts import OPSET, Part, as_function, inlined, inputs_of, traced
from export.pa_one_graph import GraphSizes, graph
from export.pa_one_names import COORDINATES, MATRICES, Names
from export.repairs import first_ends, repair_parts
from export.sizes import with_shared_sizes
from models.data.preferences import FLAT, weights
from models.networks.joining.candidates import single_cities
from models.networks.joining.costs import CANDIDATES, Problem
from models.networks.pa_one import MANY, OneActor
from models.networks.pa_one_matrix import OneMatrixActor
from models.rollout_repairs import EARLY, LATE, LATE_FROM

_ROOM = 3_000_000  # costs of a block, 12 MB; a round takes a few times as much


class _Traced(NamedTuple):
    """Sizes to trace at: all different, and different from all that is fixed."""

    objectives: int
    cities: int
    rows: int
    ends: int
    ends_before: int  # of a contracted problem
    some_cities: int  # to make lists of
    length: int  # of a list
    near: int  # cities to choose from in a repair
    cut: int  # of these

    @property
    def axes(self) -> set[int]:
        """The sizes of the axes of all tensors that parts are given."""
        problems = (self.cities, self.ends_before, 3 * self.cut)  # three columns for a cut
        return {
            *(*self, 2 * self.objectives),
            *(size for n in problems for size in (n, n + CANDIDATES, 2 * n, 2 * n + 1)),
        }


_TRACED = _Traced(20, 17, 37, 13, 15, 14, 48, 16, 12)
_AGAIN = _Traced(22, 23, 41, 10, 19, 12, 53, 18, 14)  # to see which numbers are sizes


def to_onnx(actor: OneActor) -> ModelProto:
    """Return the actor as one graph: an instance, preferences (k, m), repairs () to tours (k, n).

    The instance is cities (n, 2m) or matrices (m, n, n), as the actor reads it. A second output,
    visited (k, n), has as many other tours that repairs visited.
    """
    names = MATRICES if isinstance(actor, OneMatrixActor) else COORDINATES
    first, again = (_parts(actor, names, sizes) for sizes in (_TRACED, _AGAIN))
    functions = [
        as_function(name, _traced(part, again[name]), part[2]) for name, part in first.items()
    ]
    room = _ROOM // len(names.tables)
    sizes = GraphSizes(room, actor.list_sizes, MANY, EARLY, LATE, LATE_FROM)
    model = inlined(parser.parse_model(graph(names, OPSET, sizes)), functions)
    onnx.checker.check_model(model, full_check=True)
    return model


def _traced(part: Part, again: Part) -> ModelProto:
    """Return the graph of a part, given with other inputs again, with each size computed once."""
    model = traced(*part, _TRACED.axes)
    return with_shared_sizes(model, *(inputs_of(model, each) for each in (part, again)))


def _parts(actor: OneActor, names: Names, sizes: _Traced) -> dict[str, Part]:
    """Return the functions that the text calls, by name, to be traced at these sizes."""
    given, flat = (
        (_instance(names, sizes.cities, m), torch.rand(sizes.rows, m))
        for m in (sizes.objectives, FLAT)
    )
    problem, flat_problem = (_problem(actor, *each) for each in (given, flat))
    alone = single_cities(problem.tables)
    some, more = (first_ends(alone, count) for count in (sizes.ends, sizes.ends_before))
    # The other cities are nowhere.
    more = more._replace(left=torch.full_like(more.left, sizes.ends_before))
    listed = torch.arange(sizes.some_cities), torch.zeros(sizes.length)
    return {
        **pa_one_two.parts(actor, names, (flat[1], flat_problem), listed),
        **pa_one_lists.parts(actor, names, given, listed, (problem, some, more)),
        **repair_parts(actor, names, problem, (sizes.near, sizes.cut), sizes.ends),
    }


def _instance(names: Names, n: int, objectives: int) -> Tensor:
    return torch.rand(objectives, n, n) if names is MATRICES else torch.rand(n, 2 * objectives)


@torch.no_grad()
def _problem(actor: OneActor, instance: Tensor, preferences: Tensor) -> Problem:
    return actor.problem(instance, weights(preferences))
