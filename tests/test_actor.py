"""The released network, as the service runs it."""

import hashlib
import json
import time
from functools import cache
from pathlib import Path
from threading import Timer

import numpy as np
import pytest

from models.data.matrices import planes
from service.actor import OnnxActor, load_actors
from service.errors import Cancelled
from service.instance import Instance
from service.onnx_runtime import onnxruntime
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


def test_repairs_add_a_visited_tour_for_each_preference(actor: OnnxActor) -> None:
    instance = Instance(coordinates=np.random.default_rng(0).random((30, 4)))
    tours = actor.tours(instance, from_angles(fan(5)), repairs=3)
    np.testing.assert_array_equal(np.sort(tours, axis=1), np.tile(np.arange(30), (10, 1)))
    assert (tours[:5] != actor.tours(instance, from_angles(fan(5)))).any()


def test_repairs_are_refused_where_the_file_has_no_input_for_them(tmp_path: Path) -> None:
    actor = OnnxActor(by_row_sums(tmp_path / "sums.onnx"), threads=1)
    with pytest.raises(ValueError, match="sums cannot repair tours, got repairs 1"):
        actor.tours(Instance(coordinates=np.eye(4)), from_angles(fan(2)), repairs=1)


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


def test_two_files_of_one_actor_are_named(tmp_path: Path) -> None:
    for file in ("a.onnx", "b.onnx"):
        always_city_0(tmp_path / file, METADATA)
    with pytest.raises(ValueError, match=r"got broken in \S*a\.onnx and \S*b\.onnx"):
        load_actors(tmp_path, threads=1)


@pytest.mark.parametrize("content", [b"", b"no network", RELEASED.read_bytes()[:5000]])
def test_a_file_that_is_no_network_is_named(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "torn.onnx").write_bytes(content)
    with pytest.raises(ValueError, match=r"torn\.onnx must be an ONNX file that can be read"):
        load_actors(tmp_path, threads=1)


CITIES = np.random.default_rng(4).random((30, 4))
DEGENERATE = {
    "one place": np.ones((30, 4)),
    "two places": CITIES[np.arange(30) % 2],
    "half at one place": np.where(np.arange(30)[:, None] < 15, 0.5, CITIES),
    "one place in plane 1": CITIES * [0, 0, 1, 1],
    "one place in plane 2": CITIES * [1, 1, 0, 0],
    "hardly apart": np.concatenate((CITIES[:1], 0.5 + 1e-300 * CITIES[1:])),
}


@cache
def released_actor(name: str) -> OnnxActor:
    return OnnxActor(RELEASED.with_name(f"{name}.onnx"), threads=1)


@pytest.mark.parametrize("name", ["pa-one", "pa-one-matrix", "pa-ad", "pa-at", "pa-ean"])
@pytest.mark.parametrize("cities", DEGENERATE.values(), ids=DEGENERATE)
@pytest.mark.parametrize("kind", ["coordinates", "matrices"])
def test_zero_costs_are_planned_like_any_others(name: str, cities: np.ndarray, kind: str) -> None:
    actor = released_actor(name)
    instance = Instance(coordinates=cities)
    if kind == "matrices":
        instance = Instance(matrices=instance.scaled_matrices)
    if not actor.info.serves(instance.kind):
        return
    tours = actor.tours(instance, from_angles(np.array([0.0, 45.0, 90.0])))
    np.testing.assert_array_equal(np.sort(tours, axis=1), np.tile(np.arange(30), (3, 1)))


def test_cities_at_one_place_are_visited_in_a_run(actor: OnnxActor) -> None:
    places = np.random.default_rng(5).random((9, 4))
    number = np.random.default_rng(6).integers(0, 9, 60)
    preferences = from_angles(fan(5))
    tours = actor.tours(Instance(coordinates=places[number]), preferences)
    np.testing.assert_array_equal(np.sort(tours, axis=1), np.tile(np.arange(60), (5, 1)))
    changes = (number[tours] != np.roll(number[tours], 1, axis=1)).sum(axis=1)
    assert changes.tolist() == [9] * 5


def work(path: Path, folder: Path, *instances: Instance) -> list[int]:
    """Return the bytes of the results of all operations of a network that builds 20 tours of each.

    ONNX Runtime's profile has them. Unlike seconds they do not depend on the machine.
    """
    options = onnxruntime.SessionOptions()
    options.enable_profiling, options.profile_file_prefix = True, str(folder / "profile")
    actor = OnnxActor(path, threads=1)
    session = actor._session = onnxruntime.InferenceSession(path, options)
    for instance in instances:
        tours = actor.tours(instance, from_angles(fan(20)))
        assert (np.sort(tours, axis=1) == np.arange(instance.n)).all()
    events = json.loads(Path(session.end_profiling()).read_text())
    runs = [event for event in events if event["name"] == "model_run"]
    assert len(runs) == len(instances)
    return [
        sum(
            int(event.get("args", {}).get("output_size", 0))
            for event in events
            if run["ts"] <= event["ts"] < run["ts"] + run["dur"]
        )
        for run in runs
    ]


def test_many_cities_at_one_place_are_as_much_work_as_one(tmp_path: Path) -> None:
    cities = np.random.default_rng(7).random((400, 4))
    few = Instance(coordinates=cities[:51].copy())
    cities[51:] = cities[50]
    of_few, of_many = work(RELEASED, tmp_path, few, Instance(coordinates=cities))
    assert 0 < of_many == of_few


def test_cities_that_coincide_in_one_plane_are_no_more_work_than_others(tmp_path: Path) -> None:
    usual = np.random.default_rng(9).random((1000, 4))
    instances = [usual]
    for coinciding in (990, 980):
        cities = usual.copy()
        cities[:coinciding, :2] = cities[coinciding:, 2:] = 0.5
        instances.append(cities)
    works = work(RELEASED, tmp_path, *(Instance(coordinates=each) for each in instances))
    assert 0 < max(works) < 4 * works[0]


def test_equal_costs_are_no_more_work_than_others(tmp_path: Path) -> None:
    path = RELEASED.with_name("pa-one-matrix.onnx")
    random = np.random.default_rng(10)
    costs = random.random((2, 400, 400))
    half = np.where(random.integers(0, 2, 400) == random.integers(0, 2, (400, 1)), 1.0, 9.0)
    tied = (np.full_like(costs, 7.0), np.stack((half, half)), np.stack((costs[0], half)))
    works = work(path, tmp_path, *(Instance(matrices=each) for each in (costs, *tied)))
    assert 0 < max(works) < 4 * works[0]


def test_edges_that_cost_less_than_their_prices_are_joined() -> None:
    actor = OnnxActor(RELEASED.with_name("pa-one-matrix.onnx"), threads=1)
    instance = Instance(matrices=planes(50, np.random.default_rng([50, 8])))  # some do in repairs
    tours = actor.tours(instance, from_angles(fan(100)), repairs=1)
    np.testing.assert_array_equal(np.sort(tours, axis=1), np.tile(np.arange(50), (200, 1)))


def test_a_call_under_way_is_terminated_and_the_next_is_not(actor: OnnxActor) -> None:
    instance = Instance(coordinates=np.random.default_rng(8).random((1000, 4)))
    actor.terminate()
    Timer(0.2, actor.terminate).start()
    began = time.monotonic()
    with pytest.raises(Cancelled):
        actor.tours(instance, from_angles(fan(200)), repairs=200)  # minutes
    assert time.monotonic() - began < 30
    assert actor.tours(Instance(coordinates=np.eye(4)), from_angles(fan(2))).shape == (2, 4)
