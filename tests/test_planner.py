"""From an instance to its front: properties against brute force."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from service.actor import OnnxActor
from service.construction.call_estimate import CallEstimate
from service.construction.repairs import TOURS_REPAIRED, repairs_worth
from service.front import Front, PlanOptions
from service.instance import Instance, RouteEnds, tour_lengths
from service.pareto import hypervolume, nondominated
from service.planner import plan
from service.preferences import fan, spread
from service.search.warm_up import warm_up
from service.settings import Settings
from tests.helpers.instances import ENDS, KINDS, every_tour, opened, small_integers
from tests.helpers.sampled import sixth, third

pytestmark = pytest.mark.usefixtures("compiled")

SMALL = (
    st.integers(1, 7)
    .flatmap(lambda n: arrays(np.float64, (n, 4), elements=st.integers(0, 4)))
    .map(lambda coordinates: Instance(coordinates=coordinates))
)


class Everything:
    """A constructor that builds every tour there is, whatever the preferences."""

    estimate = CallEstimate("coordinates")

    def tours(self, instance: Instance, *_: object) -> np.ndarray:
        return np.array(list(permutations(range(instance.n))))

    def terminate(self) -> None:
        """Do nothing: no call takes long."""


class InOrder(Everything):
    """A constructor whose tours all visit the cities in their order."""

    def tours(self, instance: Instance, preferences: np.ndarray, *_: object) -> np.ndarray:
        return np.tile(np.arange(instance.n), (len(preferences), 1))


@pytest.fixture(scope="module")
def matrix_actor() -> OnnxActor:
    return OnnxActor(Settings().actors / "pa-one-matrix.onnx", threads=1)


@pytest.fixture(scope="module")
def actor() -> OnnxActor:
    return OnnxActor(Settings().actors / "pa-one.onnx", threads=1)


def random_instance(n: int) -> Instance:
    return Instance(coordinates=np.random.default_rng(n).random((n, 4)))


def check(front: Front, instance: Instance) -> None:
    """What holds of every front."""
    n = instance.n
    np.testing.assert_array_equal(np.sort(front.tours, axis=1), [range(n)] * len(front.tours))
    np.testing.assert_allclose(front.points, tour_lengths(instance, front.tours))
    assert len(nondominated(front.points)) == len(front.points)
    assert (np.diff(front.points[:, 0]) > 0).all()
    assert front.hypervolume == hypervolume(front.points, front.reference_point)


@given(SMALL)
def test_of_every_tour_the_front_keeps_the_nondominated(instance: Instance) -> None:
    front = plan(Everything(), instance, PlanOptions(directions=spread(3), size=1000))
    check(front, instance)
    every = tour_lengths(instance, Everything().tours(instance, fan(1)))
    kept = every[nondominated(every)]
    np.testing.assert_allclose(front.points, kept)
    assert front.found == len(kept)


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 6, 7, 8])
def test_no_front_is_better_than_brute_force(actor: OnnxActor, n: int) -> None:
    instance = random_instance(n)
    front = plan(actor, instance, PlanOptions(directions=spread(20), size=100))
    check(front, instance)
    best = tour_lengths(instance, Everything().tours(instance, fan(1)))
    slack = 1e-9
    for point in front.points:
        assert (best <= point + slack).all(axis=1).any()
    assert front.hypervolume <= hypervolume(best, front.reference_point) + slack


def test_open_routes_equal_brute_force_on_200_instances(actor: OnnxActor) -> None:
    for seed in range(sixth(200)):
        n, kind, ends = 3 + seed % 7, KINDS[seed % 3], ENDS[seed % 4]
        instance = opened(small_integers(kind, n, seed), ends, seed)
        options = PlanOptions(directions=spread(5), size=1000, time_limit=1.0)
        front = plan(actor if kind == "coordinates" else InOrder(), instance, options)
        check(front, instance)
        assert instance.start is None or (front.tours[:, 0] == instance.start).all()
        assert instance.end is None or (front.tours[:, -1] == instance.end).all()
        every = tour_lengths(instance, every_tour(instance))
        best = every[nondominated(every.round(9))]
        np.testing.assert_allclose(front.points, best, rtol=1e-12)


@pytest.mark.parametrize("ends", ENDS)
@pytest.mark.parametrize("kind", ["coordinates", "matrices"])
def test_without_a_search_the_network_plans_open_routes(
    kind: str, ends: str, actor: OnnxActor, matrix_actor: OnnxActor
) -> None:
    instance = random_instance(40)
    if kind == "matrices":
        instance = Instance(matrices=np.random.default_rng(1).random((2, 40, 40)))
    instance = opened(instance, ends)
    network = actor if kind == "coordinates" else matrix_actor
    options = PlanOptions(directions=spread(20), size=100)
    front = plan(network, instance, options)
    check(front, instance)
    assert instance.start is None or (front.tours[:, 0] == instance.start).all()
    assert instance.end is None or (front.tours[:, -1] == instance.end).all()
    in_order = plan(InOrder(), instance, options)
    assert front.hypervolume > in_order.hypervolume + 0.1


def test_open_routes_of_two_cities_go_both_ways() -> None:
    matrices = np.array([[[0, 1], [5, 0]], [[0, 7], [2, 0]]])
    instance = Instance(matrices=matrices, closed=False)
    front = plan(InOrder(), instance, PlanOptions(directions=spread(3), size=10))
    assert front.tours.tolist() == [[0, 1], [1, 0]]
    assert front.points.tolist() == [[1, 7], [5, 2]]


@pytest.mark.parametrize("size", [1, 2, 5])
def test_a_larger_front_is_cut_to_size(size: int) -> None:
    instance = random_instance(6)
    whole = plan(Everything(), instance, PlanOptions(directions=spread(3), size=1000))
    cut = plan(Everything(), instance, PlanOptions(directions=spread(3), size=size))
    check(cut, instance)
    assert len(cut.points) == size < whole.found == cut.found
    assert cut.hypervolume <= whole.hypervolume


@settings(max_examples=third(20))
@given(st.data())
def test_every_tour_is_reported_from_the_start(data: st.DataObject) -> None:
    instance = data.draw(SMALL)
    start = data.draw(st.integers(0, instance.n - 1))
    front = plan(Everything(), instance, PlanOptions(directions=spread(3), size=1000, start=start))
    assert (front.tours[:, 0] == start).all()
    check(front, instance)


@pytest.mark.parametrize("n", [1, 2])
def test_one_or_two_cities_are_a_front_of_one_tour(actor: OnnxActor, n: int) -> None:
    front = plan(actor, random_instance(n), PlanOptions(directions=spread(3), size=10, start=n - 1))
    assert front.tours.tolist() == [[n - 1, 0][:n]]


def test_coincident_cities_are_one_point_at_the_origin(actor: OnnxActor) -> None:
    front = plan(
        actor, Instance(coordinates=np.ones((4, 4))), PlanOptions(directions=spread(3), size=10)
    )
    assert front.points.tolist() == [[0, 0]]
    assert (front.hypervolume, front.angles.tolist()) == (1, [45])
    assert front.reference_point.tolist() == [4, 4]


def test_the_reference_point_is_n_times_the_scale_unless_given() -> None:
    instance = random_instance(5)
    front = plan(Everything(), instance, PlanOptions(directions=spread(1), size=9))
    np.testing.assert_array_equal(front.reference_point, 5 * instance.scale)
    point = np.array([3.0, 4.0])
    front = plan(
        Everything(), instance, PlanOptions(directions=spread(1), size=9, reference_point=point)
    )
    np.testing.assert_array_equal(front.reference_point, point)


def test_angles_are_those_of_scaled_objectives() -> None:
    points = np.array([[1.0, 200.0], [2.0, 100.0], [4.0, 50.0]])
    front = Front(
        tours=np.tile(np.arange(3), (3, 1)),
        points=points,
        found=3,
        constructed=3,
        scale=np.array([1.0, 50.0]),
        reference_point=np.array([10.0, 1000.0]),
        hypervolume=0.0,
        terminated="converged",
        timings={},
    )
    assert front.angles[1] == pytest.approx(45)
    assert (np.diff(front.angles) < 0).all()


def test_what_the_search_gained_is_what_it_added_to_the_first_tours(actor: OnnxActor) -> None:
    warm_up()  # else the time may be up before the search begins
    instance = random_instance(30)
    demand = PlanOptions(directions=spread(5), size=10_000)
    first = plan(actor, instance, demand)
    improved = plan(actor, instance, replace(demand, time_limit=0.1))
    assert first.gained is None
    assert improved.gained is not None
    assert improved.gained > 0
    assert np.isclose(improved.gained, improved.hypervolume - first.hypervolume)


@pytest.mark.parametrize("n", [40, 200])
def test_repairs_make_a_front_better_and_may_fill_it_up(actor: OnnxActor, n: int) -> None:
    instance, demand = random_instance(n), PlanOptions(directions=spread(20), size=100)
    plain, repaired = (plan(actor, instance, replace(demand, repairs=r)) for r in (0, 5))
    check(repaired, instance)
    assert repaired.hypervolume > plain.hypervolume
    assert repaired.constructed == TOURS_REPAIRED * plain.constructed
    assert len(plan(actor, instance, replace(demand, repairs=5, size=7)).tours) == 7


@pytest.mark.parametrize("ends", [RouteEnds(False), RouteEnds(False, 3), RouteEnds(False, 3, 7)])
def test_repairs_make_open_routes_better(actor: OnnxActor, ends: RouteEnds) -> None:
    instance = replace(random_instance(40), **ends._asdict())
    demand = PlanOptions(directions=spread(20), size=100)
    plain, repaired = (plan(actor, instance, replace(demand, repairs=r)) for r in (0, 5))
    check(repaired, instance)
    assert repaired.hypervolume > plain.hypervolume


def test_fewer_repairs_are_as_many_as_are_worth_their_time(actor: OnnxActor) -> None:
    instance = random_instance(60)
    default = PlanOptions(directions=spread(20), size=100, repairs=200, fewer_repairs=True)
    worth = replace(
        default, repairs=repairs_worth("coordinates", 60, objectives=2), fewer_repairs=False
    )
    least = replace(default, repairs=1)
    fronts = [plan(actor, instance, each) for each in (default, worth, least)]
    np.testing.assert_array_equal(fronts[0].points, fronts[1].points)
    assert fronts[2].hypervolume < fronts[0].hypervolume
