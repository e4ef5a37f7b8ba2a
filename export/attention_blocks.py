"""Attention of PA-One for matrices in ONNX, block by block of cities, so that memory stays small.

At once, the scores of n cities are groups x heads x n x n numbers, 4 GB at 5,000 cities. In the
exported graph a node stands for the attention of a layer, and an ONNX function defines it: a Loop
over blocks of queries, which computes how near the cities of its block are to all cities.
"""

from copy import deepcopy

import torch
from onnx import ModelProto, inliner, parser
from torch import Tensor

from models.networks.actor import StepwiseActor
from models.networks.layers import SeeFading
from models.networks.pa_one_matrix import MatrixEncoder

_BLOCK = 64  # cities whose scores fit into a processor's cache

# Queries, keys and values are (g, h, n, e), rates (h, 3 s), costs (1, s, 2, n, n), weights (g, 2).
# In the loop, m is the cities of the block.
_SEE = """
<domain: "paretour", opset_import: ["": 20]>
See (query, key, value, rates, costs, weights) => (seen)
{
    zero = Constant <value_ints = [0]> ()
    one = Constant <value_ints = [1]> ()
    two = Constant <value_ints = [2]> ()
    block = Constant <value_ints = [%d]> ()
    n = Shape <start = 2, end = 3> (query)
    groups = Shape <start = 0, end = 1> (weights)
    heads = Shape <start = 0, end = 1> (rates)
    rest = Constant <value_ints = [-1]> ()

    e = Shape <start = 3, end = 4> (query)
    e_as_float = CastLike (e, query)
    root = Sqrt (e_as_float)
    scaled = Div (query, root)
    key_columns = Transpose <perm = [0, 1, 3, 2]> (key)
    falling = Neg (rates)
    by_kind = Squeeze (costs, zero)
    kinds = Shape <start = 0, end = 1> (by_kind)

    more = Add (n, block)
    filled = Sub (more, one)
    blocks = Div (filled, block)
    trips = Squeeze (blocks)
    nothing = Slice (query, zero, zero, two)
    seen = Loop (trips, , nothing) <body = see_block
        (int64 index, bool before, float[g, h, m_before, e] so_far)
        => (bool after, float[g, h, m_after, e] grown)
        {
            after = Identity (before)
            index_row = Reshape (index, one)
            first = Mul (index_row, block)
            beyond = Add (first, block)
            last = Min (beyond, n)
            asking = Slice (scaled, first, last, two)
            apart = Slice (by_kind, first, last, two)
            m = Sub (last, first)

            planes_shape = Concat <axis = 0> (kinds, two, rest)
            planes = Reshape (apart, planes_shape)
            by_weight = MatMul (weights, planes)
            weighted_shape = Concat <axis = 0> (kinds, groups, one, rest)
            weighted = Reshape (by_weight, weighted_shape)
            planes_once = Unsqueeze (planes, one)
            times = Concat <axis = 0> (one, groups, one, one)
            planes_of_groups = Tile (planes_once, times)
            by_kind_and_group = Concat <axis = 2> (planes_of_groups, weighted)
            by_group = Transpose <perm = [1, 0, 2, 3]> (by_kind_and_group)
            steps = Mul (m, n)
            measures_shape = Concat <axis = 0> (groups, rest, steps)
            measures = Reshape (by_group, measures_shape)
            unit = Constant <value_float = 1.0> ()
            raised = Add (measures, unit)
            far = Log (raised)
            faded = MatMul (falling, far)
            scores_shape = Concat <axis = 0> (groups, heads, m, n)
            bias = Reshape (faded, scores_shape)

            alike = MatMul (asking, key_columns)
            scores = Add (alike, bias)
            shares = Softmax <axis = -1> (scores)
            part = MatMul (shares, value)
            grown = Concat <axis = 2> (so_far, part)
        }>
}
"""


def with_nodes(actor: StepwiseActor) -> StepwiseActor:
    """Return the actor with its fading attention as nodes of the graph that it is exported to."""
    changed = deepcopy(actor)
    if isinstance(changed.encoder, MatrixEncoder):
        changed.encoder.seeing = _node
    return changed


def _node(costs: Tensor, weights: Tensor) -> SeeFading:
    def see(rates: Tensor, query: Tensor, key: Tensor, value: Tensor) -> Tensor:
        return torch.onnx.ops.symbolic(
            "paretour::See",
            (query, key, value, rates, costs, weights),
            dtype=query.dtype,
            shape=query.shape,
            version=1,
        )

    return see


def in_blocks(model: ModelProto) -> ModelProto:
    """Return the model with every such node replaced by the function above."""
    model.functions.append(parser.parse_function(_SEE % _BLOCK))
    return inliner.inline_local_functions(model)
