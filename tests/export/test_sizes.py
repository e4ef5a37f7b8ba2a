"""Sizes in a traced graph are computed once each, and the graph gives what it gave before."""

import numpy as np
import pytest
import torch
from onnx import ModelProto
from torch import Tensor, nn

from export.onnx_parts import traced
from export.sizes import with_shared_sizes
from service.onnx_runtime import onnxruntime


class Shapes(nn.Module):
    """Sizes in many a use: of views, of ranges, of what is filled, and as numbers."""

    def forward(self, table: Tensor, index: Tensor) -> tuple[Tensor, Tensor]:
        r, e = index.shape
        found = table.gather(1, index.flatten(1)).view_as(index).view(r, e // 1)
        lines = torch.arange(r, device=index.device)[:, None] * e + index
        doubled = torch.cat((torch.zeros_like(lines), lines), dim=1).flatten()
        return found.flatten().unflatten(0, (r, e)), doubled + table.shape[1] + r * e


INPUTS, OUTPUTS = ["table", "index"], ["found", "lines"]


def inputs_of(r: int, n: int, e: int) -> tuple[Tensor, Tensor]:
    return torch.rand(r, n), torch.randint(n, (r, e))


def run(model: ModelProto, inputs: tuple[Tensor, Tensor]) -> list[np.ndarray]:
    running = onnxruntime.InferenceSession(
        model.SerializeToString(), providers=["CPUExecutionProvider"]
    )
    given = (tensor.numpy() for tensor in inputs)
    return running.run(OUTPUTS, dict(zip(INPUTS, given, strict=True)))


@pytest.fixture(scope="module")
def both() -> tuple[ModelProto, ModelProto]:
    first, second = inputs_of(7, 13, 5), inputs_of(11, 17, 6)
    model = traced(Shapes(), first, INPUTS, OUTPUTS, {5, 7, 13})
    for value in model.graph.output:  # which the parts of a graph do without
        value.type.tensor_type.ClearField("shape")
    arrays = ([tensor.numpy() for tensor in inputs] for inputs in (first, second))
    return model, with_shared_sizes(model, *arrays)


@pytest.mark.parametrize("sizes", [(7, 13, 5), (1, 2, 1), (30, 4, 9)])
def test_what_it_gives_is_the_same_at_all_sizes(
    both: tuple[ModelProto, ModelProto], sizes: tuple[int, int, int]
) -> None:
    inputs = inputs_of(*sizes)
    for before, after in zip(*(run(model, inputs) for model in both), strict=True):
        np.testing.assert_array_equal(before, after)


def test_no_size_is_computed_twice(both: tuple[ModelProto, ModelProto]) -> None:
    before, after = (list(model.graph.node) for model in both)
    assert len(after) < len(before)
    computed = [
        (node.op_type, *node.input, *(attribute.i for attribute in node.attribute))
        for node in after
        if node.name.startswith("/Size") and node.op_type != "Constant"
    ]
    assert len(set(computed)) == len(computed) > 0
