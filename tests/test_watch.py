"""A watch keeps its time and says when to report, by a clock that the test moves."""

from math import inf

import pytest

from service.watch import Progress, Watch


class Clock:
    """A clock that stands still until it is moved."""

    def __init__(self) -> None:
        self.now = 50.0

    def __call__(self) -> float:
        return self.now


class Reports:
    """Notes what is reported, which takes a number of seconds."""

    def __init__(self, clock: Clock, seconds: float = 0.0) -> None:
        self.clock, self.seconds = clock, seconds
        self.came: list[tuple[float, int, str]] = []

    def __call__(self, progress: Progress, best: object) -> None:
        assert callable(best)
        self.came.append((progress.seconds, progress.points, best(2)))
        self.clock.now += self.seconds


def ask(watch: Watch[str], clock: Clock, step: float, times: int) -> None:
    """Ask for a report after each of some steps."""
    for _ in range(times):
        clock.now += step
        watch.report_if_due(lambda: (0.5, 7), lambda size: f"best {size}")


def test_time_is_over_at_the_end_or_where_the_rest_is_reserved() -> None:
    clock = Clock()
    watch = Watch[str](2.0, clock=clock)
    clock.now += 1.5
    assert (watch.spent, watch.left) == (1.5, 0.5)
    assert (watch.over(), watch.over(0.4), watch.over(0.5)) == (False, False, True)
    clock.now += 0.5
    assert watch.over()
    assert not watch.over(-0.1)
    assert not Watch[str](clock=clock).over()


def test_work_ends_with_its_time_or_when_it_is_to_stop() -> None:
    clock, stopped = Clock(), [False]
    watch = Watch[str](1.0, lambda: stopped[0], clock=clock)
    assert not watch.ended()
    stopped[0] = True
    assert watch.ended()
    assert watch.until(inf).ended()
    stopped[0] = False
    clock.now += 1.0
    assert watch.ended()
    assert not watch.until(1.5).ended()
    assert (watch.until(1.5).left, watch.lasting(1.5).left) == (0.5, 1.5)


def test_a_report_is_due_ten_times_a_second_but_not_just_before_the_end() -> None:
    clock = Clock()
    reports = Reports(clock)
    ask(Watch(0.45, report=reports, clock=clock), clock, 0.0625, 10)
    assert reports.came == [(0.125, 7, "best 2"), (0.25, 7, "best 2")]


def test_slow_reports_take_a_tenth_of_the_time() -> None:
    clock = Clock()
    reports = Reports(clock, seconds=0.0625)
    ask(Watch(report=reports, clock=clock), clock, 0.125, 11)
    assert [seconds for seconds, _, _ in reports.came] == [0.125, 0.8125, 1.5]


def test_nothing_is_reported_before_something_is_found() -> None:
    clock = Clock()
    reports = Reports(clock)
    watch = Watch(report=reports, clock=clock)
    clock.now += 1.0
    watch.report_if_due(lambda: None, str)
    assert not reports.came
    watch.report_if_due(lambda: (0.5, 1), str)
    assert reports.came == [(1.0, 1, "2")]


def test_fronts_are_converted_before_they_are_reported() -> None:
    clock = Clock()
    reports = Reports(clock)
    watch: Watch[int] = Watch(report=reports, clock=clock).converting(
        lambda front: f"{front} tours"
    )
    clock.now += 1.0
    watch.report_if_due(lambda: (0.5, 9), lambda size: 10 * size)
    assert reports.came == [(1.0, 9, "20 tours")]


@pytest.mark.parametrize("begin", [0.0, 1.0])
def test_work_within_work_is_timed_from_its_own_beginning(begin: float) -> None:
    clock = Clock()
    watch = Watch[str](9.0, clock=clock)
    clock.now += begin
    assert watch.lasting(2.0).spent == 0.0
    assert watch.until(2.0).spent == begin
