"""Exported files against their actors in torch."""

from functools import cache
from pathlib import Path

import onnx
import pytest
from onnx import ModelProto, numpy_helper

from export.__main__ import to_onnx
from export.check import Comparison, TourMismatch, compare
from models.checkpoint import load_weights
from models.config import NAMES, NetworkConfig
from models.networks.actor import Actor
from models.networks.build import build
from models.networks.pa_one import MANY
from models.rollout_repairs import LATE_FROM
from tests.helpers.sampled import IS_WHOLE, few
from tests.helpers.type_checks import unchecked_types

ROOT = Path(__file__).parents[2]
ACTORS = ROOT / "service/actors"
# To trace an actor takes many seconds: by day one for each way of export.
BY_DAY = ("pa-one", "pa-ean")


@cache
def small(name: str) -> tuple[Actor, ModelProto]:
    """A small actor and its file, whose export takes many seconds."""
    config = NetworkConfig(name=name, width=16, heads=2, layers=1, feedforward=32)
    actor = build(config, seed=2).eval()
    with unchecked_types():
        return actor, to_onnx(actor)


@pytest.fixture(params=NAMES if IS_WHOLE else BY_DAY)
def exported(request: pytest.FixtureRequest) -> tuple[Actor, ModelProto]:
    return small(request.param)


def test_the_file_builds_the_tours_that_torch_builds(exported: tuple[Actor, ModelProto]) -> None:
    actor, model = exported
    sizes = (3, 130)  # 130: more than two blocks
    compared = compare(actor, model, sizes, counts=(1,), repairs=(0, 1))
    with unchecked_types():  # of the same axes
        compared += compare(actor, model, sizes, counts=(6,), repairs=(0, 5))
    assert compared.tours >= 2 * (1 + 6) * (2 if actor.repairs_tours else 1)


def test_a_comparison_says_how_many_tours_part_after_a_tie() -> None:
    assert str(Comparison(4) + Comparison(3)) == "all 7 tours are the same"
    assert str(Comparison(4, 1, 0.01) + Comparison(3, 1, 0.002)) == (
        "5 of 7 tours are the same, and 2 part after a tie: their lengths differ by at most 1 %"
    )


@pytest.mark.parametrize("path", sorted(ACTORS.glob("*.onnx")), ids=lambda path: path.stem)
def test_the_released_file_builds_the_tours_of_the_released_checkpoint(path: Path) -> None:
    trained = load_weights(ROOT / f"models/checkpoints/{path.stem}.pt")
    # The export itself goes further.
    with unchecked_types():
        compare(trained.actor, onnx.load(path), sizes=(3, 60), counts=(20,), repairs=(0, 1, 10))


def test_late_repairs_are_those_of_torch() -> None:
    actor, model = small("pa-one")
    sizes = few(1, (30, 9))  # more cities than a late repair looks at, and fewer
    with unchecked_types():  # early repairs have the same axes
        compare(actor, model, sizes, counts=(3,), repairs=(LATE_FROM + 2,))


def test_the_file_joins_many_cities_as_torch_does() -> None:
    with unchecked_types():  # fewer cities have the same axes
        compare(*small("pa-one"), sizes=(MANY + 1,), counts=(3,), repairs=(0,))


def test_a_file_with_other_weights_is_refused(exported: tuple[Actor, ModelProto]) -> None:
    actor, model = exported
    changed = ModelProto()
    changed.CopyFrom(model)
    for weights in changed.graph.initializer:
        values = numpy_helper.to_array(weights)
        if values.ndim == 2 and values.dtype == "float32" and values.min() < 0:  # not a constant
            weights.CopyFrom(numpy_helper.from_array(-values, weights.name))
    with unchecked_types(), pytest.raises(TourMismatch, match=r"tours of .* part at position"):
        compare(actor, changed, sizes=(20,), counts=(20,))


def test_a_file_with_a_frozen_size_is_refused(exported: tuple[Actor, ModelProto]) -> None:
    actor, model = exported
    frozen = ModelProto()
    frozen.CopyFrom(model)
    frozen.graph.input[0].type.tensor_type.shape.dim[-2].dim_value = 11
    with pytest.raises(
        TourMismatch, match=r"(cities|matrices) must have shape \[.*'n', .*\], got .*11"
    ):
        compare(actor, frozen, sizes=(20,), counts=(20,))
