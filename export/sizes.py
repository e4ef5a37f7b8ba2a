"""Compute each size in a traced graph only once, from the shapes of the graph's inputs.

The exporter computes a size again wherever it is used. In a graph of many small operations, this is
a third of all operations. So the graph is run twice, on inputs of different sizes. A value that is
the same both times becomes a constant. A value that follows from one or two sizes of inputs is
computed from these at the beginning. Other values stay as they are.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from onnx import ModelProto, NodeProto, ValueInfoProto, helper, numpy_helper

from service.onnx_runtime import onnxruntime

Array = NDArray[Any]
Both = tuple[int, int]  # a number in the first run and in the second

_OF_SIZES = {
    *("Add", "Cast", "Concat", "ConstantOfShape", "Div", "Gather", "Mod", "Mul", "Reshape"),
    *("Shape", "Slice", "Squeeze", "Sub", "Transpose", "Unsqueeze"),
}
_LONGEST = 8  # tensor that is taken for sizes
_MOST_TIMES, _MOST_MORE = 10, 16  # a size of an input, and more than that
_UNCHANGING = ("Expand", "Reshape", "Flatten")  # where the shape is the same before and after


class Size(NamedTuple):
    """A size of an input, or the product of two, times a number, plus a number."""

    of: tuple[tuple[str, int], ...]  # inputs and axes
    times: int = 1
    more: int = 0


class Runs:
    """All tensors of a graph in two runs, on inputs of different sizes."""

    def __init__(self, model: ModelProto, first: Sequence[Array], second: Sequence[Array]) -> None:
        names = [value.name for value in model.graph.input]
        self.values = [_all_tensors(model, names, inputs) for inputs in (first, second)]
        self._sizes = {
            both: (name, axis)
            for name in reversed(names)
            for axis, both in reversed(list(enumerate(self.shapes(name) or ())))
            if both[0] != both[1]
        }

    def shapes(self, name: str) -> list[Both] | None:
        """Return the sizes of a tensor in both runs; None if it has other axes."""
        shapes = [values[name].shape for values in self.values]
        if len(shapes[0]) != len(shapes[1]):
            return None
        return list(zip(*shapes, strict=True))

    def numbers(self, name: str) -> list[Both] | None:
        """Return the entries of a tensor in both runs, if it may be one of sizes."""
        first, second = (values[name] for values in self.values)
        is_one = first.dtype == np.int64 and first.ndim <= 1 and first.size <= _LONGEST
        if not is_one or first.shape != second.shape:
            return None
        return [(int(a), int(b)) for a, b in zip(first.flat, second.flat, strict=True)]

    def size(self, both: Both) -> Size | None:
        """Return how a number that differs is made of the sizes of inputs; None if it is not."""
        if both in self._sizes:
            return Size((self._sizes[both],))
        sizes = list(self._sizes.items())
        for (one, of), (other, by) in product(sizes, sizes):
            if both == (one[0] * other[0], one[1] * other[1]):
                return Size((of, by))
        affine = [Size((of,), *found) for one, of in sizes if (found := _affine(one, both))]
        return min(affine, key=lambda size: (size.times - 1) + size.more, default=None)


def _affine(size: Both, both: Both) -> tuple[int, int] | None:
    times, rest = divmod(both[0] - both[1], size[0] - size[1])
    more = both[0] - times * size[0]
    fits = rest == 0 and 0 < times <= _MOST_TIMES and 0 <= more <= _MOST_MORE
    return (times, more) if fits else None


def _all_tensors(
    model: ModelProto, names: Sequence[str], inputs: Sequence[Array]
) -> Mapping[str, Array]:
    whole = ModelProto()
    whole.CopyFrom(model)
    computed = [name for node in model.graph.node for name in node.output if name]
    del whole.graph.output[:]
    whole.graph.output.extend(ValueInfoProto(name=name) for name in computed)
    options = onnxruntime.SessionOptions()
    options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_DISABLE_ALL
    options.log_severity_level = 3
    running = onnxruntime.InferenceSession(
        whole.SerializeToString(), options, providers=["CPUExecutionProvider"]
    )
    given = dict(zip(names, inputs, strict=True))
    constants = {tensor.name: numpy_helper.to_array(tensor) for tensor in model.graph.initializer}
    return {**constants, **given, **dict(zip(computed, running.run(None, given), strict=True))}


def with_shared_sizes(
    model: ModelProto, first: Sequence[Array], second: Sequence[Array]
) -> ModelProto:
    """Return a graph that computes each size once.

    The graph was traced with the first inputs, and runs on the second, whose sizes all differ.
    """
    runs = Runs(model, first, second)
    changed = ModelProto()
    changed.CopyFrom(model)
    nodes, outputs = list(changed.graph.node), {value.name for value in model.graph.output}
    of_sizes, sharing = _made_of_shapes(changed, runs), _Sharing(runs)
    unshared = [node for node in nodes if of_sizes.issuperset(node.output)]
    kept = []
    for node in nodes:
        if _changes_nothing(node, runs) and node.output[0] not in outputs | of_sizes:
            sharing.names[node.output[0]] = sharing.names.get(node.input[0], node.input[0])
        elif not of_sizes.issuperset(node.output) or not outputs.isdisjoint(node.output):
            kept.append(node)
    for node in kept:
        sharing.share(node, of_sizes)
    needed = list(_needed([*sharing.nodes, *_in_order(unshared, kept)], outputs))
    del changed.graph.node[:]
    changed.graph.node.extend(needed)
    return changed


def _in_order(unshared: Sequence[NodeProto], kept: Sequence[NodeProto]) -> list[NodeProto]:
    """Return nodes in the order in which one can be run after the other."""
    made_by = {name: node for node in (*unshared, *kept) for name in node.output}
    done: set[int] = set()
    order: list[NodeProto] = []

    def visit(node: NodeProto) -> None:
        if id(node) in done:
            return
        done.add(id(node))
        for name in node.input:
            if name in made_by:
                visit(made_by[name])
        order.append(node)

    for node in kept:
        visit(node)
    return order


def _needed(nodes: Sequence[NodeProto], outputs: set[str]) -> Iterator[NodeProto]:
    wanted = set(outputs)
    needed = []
    for node in reversed(nodes):
        if not wanted.isdisjoint(node.output):
            wanted.update(node.input)
            needed.append(node)
    return reversed(needed)


def _made_of_shapes(model: ModelProto, runs: Runs) -> set[str]:
    """Return the tensors that are computed from shapes and constants alone, and are sizes."""
    known = {tensor.name for tensor in model.graph.initializer} | {""}
    found: set[str] = set()
    for node in model.graph.node:
        if node.op_type == "Constant":
            known.update(node.output)
        elif node.op_type == "Shape" or (
            node.op_type in _OF_SIZES
            and known.issuperset(node.input)
            and runs.numbers(node.output[0]) is not None
        ):
            known.update(node.output)
            found.update(node.output)
    return found


def _changes_nothing(node: NodeProto, runs: Runs) -> bool:
    if node.op_type == "Cast":
        given, made = (runs.values[0][name].dtype for name in (node.input[0], node.output[0]))
        return bool(given == made)
    if node.op_type not in _UNCHANGING:
        return False
    before, after = (runs.shapes(name) for name in (node.input[0], node.output[0]))
    return before is not None and before == after


class _Sharing:
    """The nodes that compute sizes, and the names of what they give."""

    def __init__(self, runs: Runs) -> None:
        self.runs = runs
        self.nodes: list[NodeProto] = []
        self.names: dict[str, str] = {}  # of tensors that are others under a new name
        self._made: dict[Any, str] = {}

    def share(self, node: NodeProto, of_sizes: set[str]) -> None:
        """Have a node take what stands for its inputs."""
        before = self.runs.shapes(node.input[0]) if node.op_type == "Reshape" else None
        for place, name in enumerate(node.input):
            changing = before if place > 0 else None
            shared = self._shared(name, changing) if name in of_sizes else None
            node.input[place] = shared or self.names.get(name, name)

    def _shared(self, name: str, before: Sequence[Both] | None) -> str | None:
        """Return what stands for a tensor of sizes; before is the shape that it changes, if any."""
        numbers = self.runs.numbers(name)
        assert numbers is not None
        entries: list[int | Size] = []
        for place, both in enumerate(numbers):
            entry = both[0] if both[0] == both[1] else self.runs.size(both)
            if entry is None:
                return None
            is_kept = before is not None and place < len(before) and both == before[place]
            entries.append(0 if is_kept and isinstance(entry, Size) else entry)
        if before is not None and sum(isinstance(entry, Size) for entry in entries) == 1:
            entries = [-1 if isinstance(entry, Size) else entry for entry in entries]
        is_vector = self.runs.values[0][name].ndim == 1
        return self._vector(tuple(entries)) if is_vector else self._scalar(entries[0])

    def _vector(self, entries: tuple[int | Size, ...]) -> str:
        if all(isinstance(entry, int) for entry in entries):
            return self._constant(np.array(entries, np.int64))
        if len(entries) == 1:
            return self._size(entries[0])
        return self._node("Concat", [self._size(entry) for entry in entries], axis=0)

    def _scalar(self, entry: int | Size) -> str:
        if isinstance(entry, int):
            return self._constant(np.array(entry, np.int64))
        return self._node("Squeeze", [self._size(entry)])

    def _size(self, entry: int | Size) -> str:
        """Return the tensor, shape (1,), of one number."""
        if isinstance(entry, int):
            return self._constant(np.array([entry], np.int64))
        sizes = [self._node("Shape", [of], start=axis, end=axis + 1) for of, axis in entry.of]
        found = sizes[0] if len(sizes) == 1 else self._node("Mul", sizes)
        if entry.times != 1:
            found = self._node("Mul", [found, self._size(entry.times)])
        return found if entry.more == 0 else self._node("Add", [found, self._size(entry.more)])

    def _constant(self, value: Array) -> str:
        key = "Constant", value.shape, *value.flat
        return self._new(key, "Constant", [], value=numpy_helper.from_array(value))

    def _node(self, kind: str, inputs: list[str], **attributes: int) -> str:
        return self._new((kind, *inputs, *attributes.values()), kind, inputs, **attributes)

    def _new(self, key: Any, kind: str, inputs: list[str], **attributes: Any) -> str:
        if key not in self._made:
            name = self._made[key] = f"/Size_{len(self._made)}"
            self.nodes.append(helper.make_node(kind, inputs, [name], name, **attributes))
        return self._made[key]
