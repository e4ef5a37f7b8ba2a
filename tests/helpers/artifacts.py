"""Small ONNX files that stand in for released networks."""

from pathlib import Path

import onnx
from onnx import TensorProto, helper

METADATA = {
    "name": "broken",
    "commit": "0000000",
    "inputs": "coordinates",
    "sizes": "[20, 60]",
    "angles": "[0, 90]",
    "config": "{}",
    "figures": "{}",
}


def always_city_0(path: Path, metadata: dict[str, str]) -> Path:
    """Write a file that answers every preference with city 0 over and over; return its path."""
    graph = helper.make_graph(
        [
            helper.make_node("Transpose", ["cities"], ["turned"]),
            helper.make_node("MatMul", ["preferences", "nothing"], ["wide"]),
            helper.make_node("MatMul", ["wide", "turned"], ["zeros"]),
            helper.make_node("Cast", ["zeros"], ["tours"], to=TensorProto.INT64),
        ],
        "broken",
        [
            helper.make_tensor_value_info("cities", TensorProto.FLOAT, ["n", 4]),
            helper.make_tensor_value_info("preferences", TensorProto.FLOAT, ["k", 2]),
        ],
        [helper.make_tensor_value_info("tours", TensorProto.INT64, ["k", "n"])],
        [helper.make_tensor("nothing", TensorProto.FLOAT, [2, 4], [0.0] * 8)],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 20)], ir_version=10)
    helper.set_model_props(model, metadata)
    onnx.save(model, path)
    return path


def by_row_sums(path: Path, name: str = "sums") -> Path:
    """Write a file that reads matrices and visits cities by falling row sum; return its path.

    Rows of the first objective weigh as much as the preference's first component says, those of
    the second as much as its second.
    """
    graph = helper.make_graph(
        [
            helper.make_node("ReduceSum", ["matrices", "columns"], ["sums"], keepdims=0),
            helper.make_node("MatMul", ["preferences", "sums"], ["scores"]),
            helper.make_node("Shape", ["matrices"], ["n"], start=1, end=2),
            helper.make_node("TopK", ["scores", "n"], ["sorted", "tours"]),
        ],
        name,
        [
            helper.make_tensor_value_info("matrices", TensorProto.FLOAT, [2, "n", "n"]),
            helper.make_tensor_value_info("preferences", TensorProto.FLOAT, ["k", 2]),
        ],
        [helper.make_tensor_value_info("tours", TensorProto.INT64, ["k", "n"])],
        [helper.make_tensor("columns", TensorProto.INT64, [1], [2])],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 20)], ir_version=10)
    helper.set_model_props(model, {**METADATA, "name": name, "inputs": "matrices"})
    onnx.save(model, path)
    return path


def by_coordinates(path: Path, name: str = "places") -> Path:
    """Write a file that reads cities and visits them by falling x; return its path.

    That of the first plane weighs as much as the preference's first component says, that of the
    second as much as its second.
    """
    graph = helper.make_graph(
        [
            helper.make_node("MatMul", ["cities", "across"], ["places"]),
            helper.make_node("Transpose", ["places"], ["turned"]),
            helper.make_node("MatMul", ["preferences", "turned"], ["scores"]),
            helper.make_node("Shape", ["cities"], ["n"], start=0, end=1),
            helper.make_node("TopK", ["scores", "n"], ["sorted", "tours"]),
        ],
        name,
        [
            helper.make_tensor_value_info("cities", TensorProto.FLOAT, ["n", 4]),
            helper.make_tensor_value_info("preferences", TensorProto.FLOAT, ["k", 2]),
        ],
        [helper.make_tensor_value_info("tours", TensorProto.INT64, ["k", "n"])],
        [helper.make_tensor("across", TensorProto.FLOAT, [4, 2], [1.0, 0, 0, 0, 0, 1, 0, 0])],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 20)], ir_version=10)
    helper.set_model_props(model, {**METADATA, "name": name, "inputs": "coordinates"})
    onnx.save(model, path)
    return path
