"""Export of parts of an actor to ONNX, and their assembly into one graph."""

import logging
import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import torch
from onnx import AttributeProto, FunctionProto, GraphProto, ModelProto, TensorProto, helper, inliner
from torch import nn

DOMAIN = "paretour"  # of functions that stand for parts until they are put in their places

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


def inlined(model: ModelProto, functions: Sequence[FunctionProto]) -> ModelProto:
    """Return the model with each function inlined, and all weights in the outermost graph.

    The lines of source that nodes come from are left out: they are four fifths of a file.
    """
    model.functions.extend(functions)
    for function in model.functions:
        for node in function.node:
            del node.metadata_props[:]
    model = inliner.inline_local_functions(model)
    model.graph.initializer.extend(_taken_out(model.graph))
    return model


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


def as_function(name: str, model: ModelProto) -> FunctionProto:
    """Return a graph as a function of that name, its weights as constants inside."""
    graph = model.graph
    constants = [
        helper.make_node("Constant", [], [tensor.name], value=tensor)
        for tensor in graph.initializer
    ]
    return helper.make_function(
        DOMAIN,
        name,
        [value.name for value in graph.input],
        [value.name for value in graph.output],
        [*constants, *graph.node],
        model.opset_import,
    )
