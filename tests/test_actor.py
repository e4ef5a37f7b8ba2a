"""The released network, as the service runs it."""

import hashlib
from pathlib import Path

import numpy as np
import pytest

from service.actor import OnnxActor, load_actors
from service.instance import Instance
from service.preferences import fan, from_angles
from service.settings import Settings
from tests.helpers.artifacts import METADATA, always_city_0, by_row_sums

RELEASED = Settings().actors / "pa-one.onnx"


@pytest.fixture(scope="module")
def actor() -> OnnxActor:
    return OnnxActor(RELEASED, threads=1)


@pytest.mark.parametrize("n", [3, 7, 40, 200])
@pytest.mark.parametrize("k", [1, 20])
def test_every_preference_gets_a_tour_of_all_cities(actor: OnnxActor, n: int, k: int) -> None:
    instance = Instance(coordinates=np.random.default_rng(n).random((n, 4)))
    tours = actor.tours(instance, from_angles(fan(k)))
    assert (tours.shape, tours.dtype) == ((k, n), np.int64)
    np.testing.assert_array_equal(np.sort(tours, axis=1), np.tile(np.arange(n), (k, 1)))


def test_coincident_cities_are_fine(actor: OnnxActor) -> None:
    tours = actor.tours(Instance(coordinates=np.ones((5, 4))), from_angles(fan(3)))
    assert tours.shape == (3, 5)


def test_the_unit_of_the_coordinates_does_not_matter(actor: OnnxActor) -> None:
    cities = np.random.default_rng(1).integers(0, 1024, (30, 4)).astype(np.float64)
    unit = np.array([2.0**-10, 2.0**-10, 2.0**10, 2.0**10])
    preferences = from_angles(fan(5))
    tours = actor.tours(Instance(coordinates=cities), preferences)
    others = actor.tours(Instance(coordinates=cities * unit), preferences)
    np.testing.assert_array_equal(tours, others)


def test_the_digest_is_that_of_the_file(actor: OnnxActor) -> None:
    assert actor.info.digest == hashlib.sha256(RELEASED.read_bytes()).hexdigest()


def test_the_file_says_what_it_is(actor: OnnxActor) -> None:
    assert actor.info.name == "pa-one"
    assert actor.info.inputs == "coordinates"
    assert actor.info.commit
    assert actor.info.config
    assert len(actor.info.sizes) == len(actor.info.angles) == 2


def test_a_tour_that_is_no_permutation_is_a_bug_and_never_an_answer(tmp_path: Path) -> None:
    broken = OnnxActor(always_city_0(tmp_path / "broken.onnx", METADATA), threads=1)
    with pytest.raises(RuntimeError, match="broken built a tour that is not a permutation"):
        broken.tours(Instance(coordinates=np.eye(4)), from_angles(fan(2)))


def test_an_actor_of_matrices_reads_scaled_matrices_with_zeros_on_the_diagonal(
    tmp_path: Path,
) -> None:
    actor = OnnxActor(by_row_sums(tmp_path / "sums.onnx"), threads=1)
    matrices = np.random.default_rng(2).random((2, 9, 9)) * np.array([1e6, 1e-6]).reshape(2, 1, 1)
    preferences = from_angles(fan(7))
    tours = actor.tours(Instance(matrices=matrices), preferences)
    np.testing.assert_array_equal(tours, expected_by_row_sums(matrices, preferences))


def test_an_actor_of_matrices_serves_coordinates_by_their_distances(tmp_path: Path) -> None:
    actor = OnnxActor(by_row_sums(tmp_path / "sums.onnx"), threads=1)
    instance = Instance(coordinates=np.random.default_rng(3).random((9, 4)) * [5, 5, 700, 700])
    preferences = from_angles(fan(7))
    expected = np.argsort(-preferences @ instance.scaled_matrices.sum(axis=2))
    np.testing.assert_array_equal(actor.tours(instance, preferences), expected)


def expected_by_row_sums(matrices: np.ndarray, preferences: np.ndarray) -> np.ndarray:
    costs = matrices * (1 - np.eye(matrices.shape[1]))
    sums = costs.sum(axis=2) / costs.max(axis=(1, 2))[:, None]
    return np.argsort(-preferences @ sums)


def test_a_file_that_reads_neither_is_refused(tmp_path: Path) -> None:
    path = always_city_0(tmp_path / "odd.onnx", {**METADATA, "inputs": "words"})
    with pytest.raises(ValueError, match="must be coordinates or matrices, got 'words'"):
        OnnxActor(path, threads=1)


def test_a_file_without_metadata_is_refused(tmp_path: Path) -> None:
    path = always_city_0(tmp_path / "anonymous.onnx", {"name": "anonymous"})
    with pytest.raises(ValueError, match="must have config, commit, sizes"):
        OnnxActor(path, threads=1)


def test_actors_are_loaded_by_name(tmp_path: Path) -> None:
    always_city_0(tmp_path / "any.onnx", METADATA)
    assert list(load_actors(tmp_path, threads=1)) == ["broken"]
    always_city_0(tmp_path / "same.onnx", METADATA)
    with pytest.raises(ValueError, match="different names"):
        load_actors(tmp_path, threads=1)
