"""The estimate of a call's seconds is the inverse of what fits, and learns from calls."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.construction.call_estimate import CallEstimate
from service.instance import Kind

KINDS = st.sampled_from(["coordinates", "matrices"])
CITIES, PREFERENCES = st.integers(3, 5000), st.integers(1, 200)


@given(KINDS, CITIES, PREFERENCES)
def test_as_many_fit_as_the_estimate_says(kind: Kind, n: int, k: int) -> None:
    estimate = CallEstimate(kind)
    assert estimate.fitting(n, estimate.seconds(n, k) * (1 + 1e-9)) == k
    assert estimate.fitting(n, estimate.seconds(n, k) * (1 - 1e-6)) in (k - 1, k)


@given(KINDS, CITIES, PREFERENCES, st.integers(0, 1000))
def test_as_many_repairs_fit_as_the_estimate_says(kind: Kind, n: int, k: int, repairs: int) -> None:
    estimate = CallEstimate(kind)
    seconds = estimate.seconds(n, k, repairs)
    assert estimate.fitting_repairs(n, k, seconds * (1 + 1e-9)) == repairs
    assert estimate.fitting_repairs(n, k, 0.99 * estimate.seconds(n, k)) == 0


@given(KINDS, CITIES, PREFERENCES, st.floats(0.01, 100))
def test_calls_teach_how_fast_the_machine_is(kind: Kind, n: int, k: int, slower: float) -> None:
    known, learnt = CallEstimate(kind), CallEstimate(kind)
    for _ in range(20):
        learnt.correct(n, k, slower * known.seconds(n, k))
    assert learnt.seconds(50, 7) == pytest.approx(slower * known.seconds(50, 7), rel=1e-3)


def test_a_network_that_was_slow_is_tried_again_later() -> None:
    estimate = CallEstimate("coordinates")
    for _ in range(5):
        estimate.correct_ended()
    fitting = [estimate.fitting(200, 0.05) for _ in range(100)]
    assert fitting[0] == 0
    assert max(fitting) == 1  # and from there on calls correct it
