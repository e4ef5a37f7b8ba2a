"""First tours: as many as fit, by calls that end in time."""

import time
from threading import Event, Timer

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.actor import OnnxActor
from service.construction.call_estimate import CallEstimate
from service.construction.first_tours import SHARE, construct
from service.errors import Cancelled
from service.front import PlanOptions
from service.instance import Instance
from service.planner import plan
from service.preferences import fan, from_angles, spread
from service.search.warm_up import warm_up
from service.settings import Settings


class Counted:
    """A constructor that counts its calls, and takes some seconds for each."""

    def __init__(self, seconds: float = 0.0) -> None:
        self.estimate = CallEstimate("coordinates")
        self.calls: list[np.ndarray] = []
        self.repairs = 0  # of the last call
        self._seconds = seconds
        self._ended = Event()

    def tours(self, instance: Instance, preferences: np.ndarray, repairs: int = 0) -> np.ndarray:
        self.calls.append(preferences)
        self.repairs = repairs
        self._ended.clear()
        if self._ended.wait(self._seconds):
            raise Cancelled
        return np.tile(np.arange(instance.n), (len(preferences), 1))

    def terminate(self) -> None:
        self._ended.set()


def cities(n: int) -> Instance:
    return Instance(coordinates=np.random.default_rng(n).random((n, 4)))


def test_all_angles_that_were_asked_for_are_honoured() -> None:
    constructor = Counted()
    angles = np.array([3.0, 80.0])
    assert len(construct(constructor, cities(20), from_angles(angles))) == 2
    np.testing.assert_array_equal(constructor.calls, [from_angles(angles)])


@given(st.floats(0, 2), st.integers(3, 300), st.integers(0, 200))
def test_within_a_time_only_preferences_and_repairs_that_fit_are_made(
    within: float, n: int, repairs: int
) -> None:
    constructor, estimate = Counted(), CallEstimate("coordinates")
    tours = construct(constructor, cities(n), spread(100), repairs, within=within)
    if not constructor.calls:
        assert estimate.fitting(n, 0.25 * within) == 0
        assert tours.shape == (0, n)
        return
    [preferences] = constructor.calls
    k = len(preferences)
    assert 1 <= k <= 100
    assert constructor.repairs <= repairs
    assert estimate.seconds(n, k, constructor.repairs) <= within
    np.testing.assert_allclose(preferences, from_angles(fan(k)))


@given(st.floats(0, 2), st.integers(3, 300), st.integers(0, 200))
def test_repairs_never_exceed_a_limit_though_all_angles_are_honoured(
    limit: float, n: int, repairs: int
) -> None:
    constructor, estimate = Counted(), CallEstimate("coordinates")
    assert len(construct(constructor, cities(n), spread(50), repairs, limit=limit)) == 50
    made = constructor.repairs
    assert made <= repairs
    assert made == 0 or estimate.seconds(n, 50, made) <= limit
    assert made == repairs or estimate.seconds(n, 50, made + 1) > 0.5 * limit


def test_a_call_with_repairs_that_takes_too_long_is_ended_and_made_without() -> None:
    class SlowRepairs(Counted):
        def tours(
            self, instance: Instance, preferences: np.ndarray, repairs: int = 0
        ) -> np.ndarray:
            self._seconds = 60.0 if repairs else 0.0
            return super().tours(instance, preferences, repairs)

    constructor = SlowRepairs()
    assert len(construct(constructor, cities(20), spread(5), 3, limit=0.2)) == 5
    assert (len(constructor.calls), constructor.repairs) == (2, 0)


def test_a_call_that_takes_longer_than_its_time_is_ended_and_brings_nothing() -> None:
    constructor = Counted(seconds=60)
    before = constructor.estimate.seconds(10, 5)
    assert construct(constructor, cities(10), spread(5), within=0.1).shape == (0, 10)
    assert len(constructor.calls) == 1
    assert constructor.estimate.seconds(10, 5) > before


def test_a_call_that_somebody_else_ends_is_cancelled() -> None:
    class Ended(Counted):
        def tours(self, *_: object) -> np.ndarray:
            raise Cancelled

    with pytest.raises(Cancelled):
        construct(Ended(), cities(10), spread(5), within=10.0)


def test_the_released_network_is_ended_in_time() -> None:
    actor = OnnxActor(Settings().actors / "pa-one.onnx", threads=1)
    actor.load()
    for _ in range(30):  # it is taken for much faster than it is
        actor.estimate.correct(1000, 100, 1e-6)
    assert construct(actor, cities(1000), spread(100), within=0.05).shape == (0, 1000)


def test_a_plan_is_over_in_time_though_the_network_is_slow() -> None:
    warm_up()
    constructor = Counted(seconds=60)
    front = plan(
        constructor,
        cities(60),
        PlanOptions(directions=spread(100), size=10, fewer=True, time_limit=0.3),
    )
    assert (len(constructor.calls), front.constructed) == (1, 0)
    assert 0 < len(front.tours) <= 10
    assert front.timings["construction"] >= 1000 * SHARE * 0.3


def test_preferences_that_were_asked_for_exceed_the_limit_by_one_call_at_most() -> None:
    constructor = Counted(seconds=0.2)
    options = PlanOptions(directions=spread(7), size=10, time_limit=0.1)
    front = plan(constructor, cities(60), options)
    assert (len(constructor.calls), front.constructed) == (1, 7)
    assert front.terminated == "time_limit"


def test_preferences_that_were_asked_for_are_given_up_where_their_call_hardly_ends() -> None:
    constructor = Counted(seconds=600)
    front = plan(
        constructor, cities(60), PlanOptions(directions=spread(7), size=10, time_limit=0.1)
    )
    assert (len(constructor.calls), front.constructed) == (1, 0)
    assert len(front.tours)


def test_a_call_ends_whose_time_was_over_before_it_began() -> None:
    class Late(Counted):
        def tours(self, *args: object) -> np.ndarray:
            time.sleep(0.2)  # the time is over, and nothing runs yet that could be ended
            return super().tours(*args)

    assert construct(Late(seconds=600), cities(10), spread(5), within=0.1).shape == (0, 10)


def test_without_a_limit_all_repairs_are_made() -> None:
    constructor = Counted()
    plan(constructor, cities(60), PlanOptions(directions=spread(7), size=10, repairs=150))
    assert (len(constructor.calls), constructor.repairs) == (1, 150)


def test_repairs_of_the_released_network_end_when_it_is_told_to_stop() -> None:
    actor = OnnxActor(Settings().actors / "pa-one.onnx", threads=1)
    actor.load()
    timer = Timer(0.2, actor.terminate)
    timer.start()
    with pytest.raises(Cancelled):
        construct(actor, cities(30), spread(100), 10**6)  # hours
