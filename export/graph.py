"""One ONNX graph from an actor of either kind."""

from onnx import ModelProto

from export import pa_one, stepwise
from models.networks.build import Actor
from models.networks.pa_one import OneActor


def to_onnx(actor: Actor) -> ModelProto:
    """The actor as one graph: an instance and preferences (k, 2) to greedy tours (k, n).

    The instance is cities (n, 4) or matrices (2, n, n), whichever the actor reads.
    """
    return pa_one.to_onnx(actor) if isinstance(actor, OneActor) else stepwise.to_onnx(actor)
