"""One ONNX graph from an actor that builds tours city by city.

Its encoder and its decoding step, the body of a Loop, are exported apart and joined by hand. The
body reads the encoder's tables from the scope around it, so that nothing but the state of the
tours goes round the loop.
"""

from collections.abc import Sequence

import onnx
import torch
from onnx import GraphProto, ModelProto, NodeProto, TensorProto, helper
from torch import Tensor, nn
from torch.export import Dim

from export.onnx_parts import exported
from models.networks.actor import StepwiseActor
from models.networks.stepwise import Conditioning, Memory, Moment
from models.rollout import starts_in_turn

# Sizes to trace at: no other axis has them, so each axis shows whether it is n or k.
_N, _K = 11, 35
_AXES = {_N: Dim("n", min=2), _K: Dim("k", min=1)}
_STATE = ("recent", "first", "visited")
_INPUTS = {"coordinates": "cities", "matrices": "matrices"}  # by what an actor reads


class _Encode(nn.Module):
    """The tables that decoding needs of an instance and preferences, and the state before a step.

    The state is the last three cities, the first city and the visited cities of each tour.
    """

    def __init__(self, actor: StepwiseActor) -> None:
        super().__init__()
        self.actor = actor

    def forward(self, instance: Tensor, preferences: Tensor) -> tuple[Tensor, ...]:
        grouping = self.actor.grouped(preferences)
        memory = self.actor.remember(instance[None], grouping.rows)
        rows = self.actor.decoder.condition(grouping.rows)
        n = instance.shape[-2]
        no_city = torch.zeros_like(grouping.members) + n  # (r,)
        starts = starts_in_turn(grouping.rows, instance)
        at = no_city if self.actor.decoder.chooses_first else starts
        recent = torch.stack((at, no_city, no_city), dim=-1)
        visited = torch.arange(n) == at[:, None]
        return *memory, *rows, grouping.places, recent, at.clone(), visited


class _Step(nn.Module):
    """The state of all tours after a step, from that before it, and the cities chosen."""

    def __init__(
        self, actor: StepwiseActor, memory: type[Memory], rows: type[Conditioning]
    ) -> None:
        super().__init__()
        self.decoder, self.memory, self.rows = actor.decoder, memory, rows

    def forward(
        self,
        memory: tuple[Tensor, ...],
        rows: tuple[Tensor, ...],
        state: tuple[Tensor, Tensor, Tensor],
    ) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        recent, first, visited = state
        moment = Moment(recent[None], first[None], visited[None])
        chosen = self.decoder.logits(self.memory(*memory), self.rows(*rows), moment)[0].argmax(-1)
        each = torch.arange(visited.shape[1])
        if self.decoder.chooses_first:
            first = torch.where(first == visited.shape[1], chosen, first)
        recent = torch.cat((chosen[:, None], recent[:, :2]), dim=1)
        return recent, first.clone(), visited | (each == chosen[:, None]), chosen


def to_onnx(actor: StepwiseActor) -> ModelProto:
    """Return the actor as one graph: an instance and preferences (k, 2) to tours (k, n).

    The instance is cities (n, 4) or matrices (2, n, n), as the actor reads it.
    """
    name = _INPUTS[actor.reads]
    instance = torch.rand(_N, 4) if name == "cities" else torch.rand(2, _N, _N)
    preferences = torch.rand(_K, 2)
    with torch.no_grad():
        grouped_preferences = actor.grouped(preferences).rows
        memory = actor.remember(instance[None], grouped_preferences)
        rows = actor.decoder.condition(grouped_preferences)
        state = _Encode(actor)(instance, preferences)[-3:]
    tables = [f"memory_{i}" for i in range(len(memory))] + [f"rows_{i}" for i in range(len(rows))]
    encode = exported(
        _Encode(actor),
        (instance, preferences),
        [name, "preferences"],
        [*tables, "places", *_STATE],
        _AXES,
    )
    step = exported(
        _Step(actor, type(memory), type(rows)),
        (_contiguous(memory), _contiguous(rows), tuple(state)),
        [*tables, *_STATE],
        [*(f"next_{name}" for name in _STATE), "chosen"],
        _AXES,
    )
    return _joined(encode, step, tables, actor.decoder.chooses_first)


def _contiguous(tables: tuple[Tensor, ...]) -> tuple[Tensor, ...]:
    return tuple(table.contiguous() for table in tables)


def _joined(
    encode: ModelProto, step: ModelProto, tables: Sequence[str], chooses_first: bool
) -> ModelProto:
    body, constants = _loop_body(step.graph, set(tables))
    trips = [
        helper.make_node("Shape", [encode.graph.input[0].name], ["n_cities"], start=-2, end=-1),
        helper.make_node("Sub", ["n_cities", "given_cities"], ["trips"]),
        helper.make_node("Squeeze", ["trips"], ["trip_count"]),
    ]
    loop = helper.make_node(
        "Loop",
        ["trip_count", "", *_STATE],
        [*(f"last_{name}" for name in _STATE), "chosen"],
        body=body,
    )
    given = helper.make_tensor("given_cities", TensorProto.INT64, [1], [0 if chooses_first else 1])
    graph = helper.make_graph(
        [*encode.graph.node, *trips, loop, *_ending(chooses_first)],
        "actor",
        list(encode.graph.input),
        [helper.make_tensor_value_info("tours", TensorProto.INT64, ["k", "n"])],
        [*encode.graph.initializer, *constants, given],
    )
    model = helper.make_model(graph, opset_imports=step.opset_import, ir_version=10)
    onnx.checker.check_model(model, full_check=True)
    return model


def _loop_body(step: GraphProto, shared: set[str]) -> tuple[GraphProto, list[TensorProto]]:
    """Return the step as a Loop's body, and its constants, for the scope around it."""

    def renamed(name: str) -> str:
        return name if name in shared or not name else f"step_{name}"

    nodes = []
    for node in step.node:
        copy = NodeProto()
        copy.CopyFrom(node)
        copy.input[:] = map(renamed, node.input)
        copy.output[:] = map(renamed, node.output)
        nodes.append(copy)
    constants = []
    for constant in step.initializer:
        moved = TensorProto()
        moved.CopyFrom(constant)
        moved.name = renamed(constant.name)
        constants.append(moved)
    kinds = {"recent": TensorProto.INT64, "first": TensorProto.INT64, "visited": TensorProto.BOOL}
    others: dict[str, list[int | str]] = {"recent": [3], "first": [], "visited": ["n"]}

    def described(prefix: str) -> list[onnx.ValueInfoProto]:
        return [
            helper.make_tensor_value_info(f"step_{prefix}{x}", kinds[x], ["rows", *others[x]])
            for x in _STATE
        ]

    body = helper.make_graph(
        [*nodes, helper.make_node("Identity", ["condition"], ["go_on"])],
        "step",
        [
            helper.make_tensor_value_info("iteration", TensorProto.INT64, []),
            helper.make_tensor_value_info("condition", TensorProto.BOOL, []),
            *described(""),
        ],
        [
            helper.make_tensor_value_info("go_on", TensorProto.BOOL, []),
            *described("next_"),
            helper.make_tensor_value_info("step_chosen", TensorProto.INT64, ["rows"]),
        ],
    )
    return body, constants


def _ending(chooses_first: bool) -> list[NodeProto]:
    """Return the nodes from the chosen cities, a row a step, to tours, a row a preference."""
    if chooses_first:
        whole = [helper.make_node("Identity", ["chosen"], ["by_step"])]
    else:
        whole = [
            helper.make_node("Constant", [], ["steps"], value_ints=[0]),
            helper.make_node("Unsqueeze", ["first", "steps"], ["given"]),
            helper.make_node("Concat", ["given", "chosen"], ["by_step"], axis=0),
        ]
    return [
        *whole,
        helper.make_node("Transpose", ["by_step"], ["rows"], perm=[1, 0]),
        helper.make_node("Gather", ["rows", "places"], ["tours"], axis=0),
    ]
