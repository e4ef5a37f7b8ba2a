"""Export of parts of an actor to ONNX, and their assembly into one graph."""

import logging
import warnings
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import onnx
import torch
from numpy.typing import NDArray
from onnx import (
    AttributeProto,
    FunctionProto,
    GraphProto,
    ModelProto,
    TensorProto,
    helper,
    inliner,
    numpy_helper,
)
from torch import Tensor, nn
from torch.onnx.symbolic_helper import parse_args
from torch.onnx.utils import register_custom_op_symbolic, unregister_custom_op_symbolic

DOMAIN = "paretour"  # the domain of functions that are later replaced by parts

OPSET = 18
_REDUCTIONS = {"amax": "max", "amin": "min", "sum": "add"}

# A module, what to trace it with, and the names of its inputs and outputs.
Part = tuple[nn.Module, tuple[Any, ...], list[str], list[str]]


def exported(
    module: nn.Module,
    arguments: Any,
    inputs: Sequence[str],
    outputs: Sequence[str],
    axes: Mapping[int, Any],
) -> ModelProto:
    """Export a module as a graph of its own; axes of the given sizes become dynamic."""

    def dynamic(argument: Any) -> Any:
        if isinstance(argument, tuple):
            return tuple(dynamic(part) for part in argument)
        return {axis: axes[size] for axis, size in enumerate(argument.shape) if size in axes}

    logging.getLogger("torch.onnx").setLevel(logging.ERROR)  # it warns of torchvision's absence
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the exporter's own deprecations and axis names
        program = torch.onnx.export(
            module.eval(),
            arguments,
            input_names=list(inputs),
            output_names=list(outputs),
            dynamic_shapes=dynamic(arguments),
            dynamo=True,
            verbose=False,
        )
    assert program is not None
    return program.model_proto


def traced(
    module: nn.Module,
    arguments: tuple[Any, ...],
    inputs: Sequence[str],
    outputs: Sequence[str],
    axes: Collection[int],
) -> ModelProto:
    """Export a module as `exported` does, by the older exporter, fifty times as fast.

    It records operations one by one. A size that the module reads of one axis of a tensor stays
    dynamic; one that it reads otherwise may be frozen.

    Raises:
        ValueError: a constant of the graph is one of the sizes of axes.
    """
    tensors = _flat(arguments)
    dynamic = {
        name: [axis for axis, size in enumerate(tensor.shape) if size in axes]
        for name, tensor in zip(inputs, tensors, strict=True)
    }
    with (
        warnings.catch_warnings(),
        _reductions_of_tables(),
        TemporaryDirectory() as folder,
    ):
        warnings.simplefilter("ignore")  # the exporter is deprecated; recording has its own
        torch.onnx.export(
            module.eval(),
            arguments,
            f"{folder}/part.onnx",
            input_names=list(inputs),
            output_names=list(outputs),
            dynamic_axes=dynamic,
            opset_version=OPSET,
            dynamo=False,
        )
        model = onnx.load(f"{folder}/part.onnx")
    del model.graph.value_info[:]
    _check_sizes(model.graph, axes)
    return model


def _check_sizes(graph: GraphProto, axes: Collection[int]) -> None:
    for node in graph.node:
        if node.op_type == "Constant":
            values = numpy_helper.to_array(node.attribute[0].t)
            if values.dtype == np.int64 and not set(values.flatten().tolist()).isdisjoint(axes):
                raise ValueError(f"a size must not be frozen, got {node.name}: {values}")


def inputs_of(model: ModelProto, part: Part) -> list[NDArray[Any]]:
    """Return the arrays with which a part is traced: the inputs that its graph has."""
    by_name = dict(zip(part[2], _flat(part[1]), strict=True))
    return [by_name[value.name].numpy() for value in model.graph.input]


def _flat(argument: Any) -> list[Tensor]:
    if not isinstance(argument, tuple):
        return [argument]
    return [tensor for part in argument for tensor in _flat(part)]


@contextmanager
def _reductions_of_tables() -> Iterator[None]:
    """Export scatter_reduce without the case of tensors that have no axis."""

    @parse_args("v", "i", "v", "v", "s", "b")
    def scatter_reduce(
        graph: Any, table: Any, axis: int, index: Any, source: Any, reduce: str, _: bool
    ) -> Any:
        how = _REDUCTIONS[reduce]
        return graph.op("ScatterElements", table, index, source, axis_i=axis, reduction_s=how)

    register_custom_op_symbolic("aten::scatter_reduce", scatter_reduce, OPSET)
    try:
        yield
    finally:
        unregister_custom_op_symbolic("aten::scatter_reduce", OPSET)


def inlined(model: ModelProto, functions: Sequence[FunctionProto]) -> ModelProto:
    """Return the model with each function inlined, and all weights in the outermost graph.

    Equal weights are there once. The lines of source that nodes come from are left out: they are
    four fifths of a file.
    """
    model.functions.extend(functions)
    for function in model.functions:
        for node in function.node:
            del node.metadata_props[:]
    model = inliner.inline_local_functions(model)
    kept: dict[bytes, TensorProto] = {}
    names = {}
    for constant in _taken_out(model.graph):
        names[constant.name] = kept.setdefault(_content(constant), constant).name
    model.graph.initializer.extend(kept.values())
    _rename(model.graph, names)
    return model


def _content(constant: TensorProto) -> bytes:
    """Return the bytes of a constant without its name."""
    unnamed = TensorProto()
    unnamed.CopyFrom(constant)
    unnamed.ClearField("name")
    return unnamed.SerializeToString()


def _rename(graph: GraphProto, names: Mapping[str, str]) -> None:
    """Give the inputs of all nodes of a graph and its subgraphs new names."""
    for node in graph.node:
        node.input[:] = [names.get(name, name) for name in node.input]
        for attribute in node.attribute:
            if attribute.type == AttributeProto.GRAPH:
                _rename(attribute.g, names)


def _taken_out(graph: GraphProto) -> list[TensorProto]:
    """Remove the constant tensors of a graph and its subgraphs, and return them."""
    constants, others = [], []
    for node in graph.node:
        if node.op_type == "Constant" and node.attribute[0].name == "value":
            constant = TensorProto()
            constant.CopyFrom(node.attribute[0].t)
            constant.name = node.output[0]
            constants.append(constant)
        else:
            others.append(node)
            for attribute in node.attribute:
                if attribute.type == AttributeProto.GRAPH:
                    constants += _taken_out(attribute.g)
    del graph.node[:]
    graph.node.extend(others)
    return constants


def as_function(name: str, model: ModelProto, inputs: Sequence[str]) -> FunctionProto:
    """Return a graph as a function of that name, its weights as constants inside.

    Of its inputs the graph may lack those that it does not use.
    """
    graph = model.graph
    constants = [
        helper.make_node("Constant", [], [tensor.name], value=tensor)
        for tensor in graph.initializer
    ]
    return helper.make_function(
        DOMAIN,
        name,
        inputs,
        [value.name for value in graph.output],
        [*constants, *graph.node],
        model.opset_import,
    )
