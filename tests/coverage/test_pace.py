"""The time of a survey: refused once it is over, or early where it clearly would be."""

import math
import time
from collections.abc import Callable

import numpy as np
import pytest

from service.coverage.coverage import Coverage
from service.coverage.pace import Pace
from service.coverage.survey import survey
from service.errors import Refusal

SEARCH = 0.02  # seconds


def never() -> bool:
    return False


def search() -> None:
    """Take SEARCH seconds of the processor."""
    began = time.thread_time()
    while time.thread_time() < began + SEARCH:
        pass


def searches_until_refused(pace: Pace, searches: int) -> int:
    """Return the number of searches of SEARCH seconds until the refusal; all without one."""
    before_search = pace.of(searches)
    for done in range(searches):
        if is_refused(before_search):
            return done
        search()
    return searches


def is_refused(before_search: Callable[[], bool]) -> bool:
    try:
        before_search()
    except Refusal as refusal:
        return refusal.code == "survey-too-long"
    return False


def test_what_fits_is_not_refused() -> None:
    assert searches_until_refused(Pace(60, never, cells=9, places=9), 5) == 5


def test_what_clearly_takes_too_long_is_refused_early() -> None:
    assert searches_until_refused(Pace(1.0, never, cells=9, places=9), 10_000) < 25


def test_what_is_estimated_too_low_is_refused_at_the_limit() -> None:
    before_search = Pace(0.1, never, cells=9, places=9).of(1)
    began = time.thread_time()
    while not is_refused(before_search):
        search()
    assert time.thread_time() - began > 0.1


def test_time_that_one_kind_of_search_took_is_missing_to_the_next() -> None:
    pace = Pace(1.0, never, cells=9, places=9)
    assert searches_until_refused(pace, 20) == 20
    assert searches_until_refused(pace, 40) < 40


def test_it_says_when_to_stop() -> None:
    assert Pace(math.inf, lambda: True, cells=9, places=9).of(3)()


@pytest.mark.parametrize("detours", [False, True])
def test_a_survey_is_refused_with_the_places_that_fit(detours: bool) -> None:
    room = Coverage(
        blocked=np.zeros((60, 60), np.bool_),
        cell_size=1,
        spacing=4,
        cost_layers=np.ones((1, 60, 60)),
        detours=detours,
    )
    assert len(survey(room, 1000, never).places) == 225
    with pytest.raises(Refusal, match="225 places over 3600 free cells") as raised:
        survey(room, 1000, never, 1e-6)
    assert raised.value.limit == 1e-6
    assert "about 2 places" in str(raised.value)


def test_time_that_the_thread_waits_does_not_count() -> None:
    before_search = Pace(0.05, never, cells=9, places=9).of(2)
    time.sleep(0.2)
    assert not is_refused(before_search)


def test_one_search_that_takes_long_is_not_taken_for_all() -> None:
    pace = Pace(1.0, never, cells=9, places=9)
    assert searches_until_refused(pace, 10) == 10  # a fifth of the time
    before_search = pace.of(100)
    before_search()
    search()
    assert not is_refused(before_search)
