"""Replanned fronts against brute force on the remaining problem, over random changes."""

import json

import numpy as np
import pytest
from paretour.choice import balances

from service.errors import Refusal
from service.front import Front, PlanOptions, SearchResult
from service.instance import Instance, tour_lengths
from service.kinds.parsing import parse_replan
from service.pareto import nondominated
from service.preferences import spread
from service.replanning.earlier_tours import EarlierTours, few_enough, touched_cities
from service.replanning.insertion import completed
from service.replanning.kept_legs import kept_shares, with_most_kept_at
from service.replanning.replan import replan
from service.requests.limits import Limits
from service.requests.replan.way import ReplanSource
from service.requests.stops import Stops
from service.requests.task import Task
from tests.helpers.actors import Shuffler, info_of
from tests.helpers.changes import Change, random_change
from tests.helpers.sampled import third

CHANGES, PARTS = 300, 10
LIMITS = Limits(body_bytes=2**20, cities=50, cells=100, preferences=99, size=9999, seconds=9)
INFOS = {kind: info_of(kind, kind) for kind in ("coordinates", "matrices")}


def task_of(change: Change, **more: object) -> Task:
    body = json.dumps({**change.request, "size": 9999, **more}).encode()
    return parse_replan(ReplanSource(body, change.front), LIMITS, INFOS)


def instance_of(task: Task) -> Instance:
    assert isinstance(task.subject, Stops)
    return task.subject.instance


def replanned(task: Task) -> Front:
    assert task.earlier is not None
    return replan(Shuffler(), instance_of(task), task.earlier, task.options)


def ways(task: Task, front: Front, change: Change) -> list[tuple[int, ...]]:
    """The tours of a front in indexes of all stops."""
    assert task.labels is not None
    index = [change.ids.index(stop.id) for stop in task.labels.stops]
    return [tuple(index[city] for city in tour) for tour in front.tours.tolist()]


@pytest.mark.parametrize("part", range(PARTS))
def test_up_to_nine_stops_the_front_of_the_rest_is_that_of_all_ways(part: int) -> None:
    for seed in range(part, CHANGES, PARTS):
        change = random_change(seed)
        task = task_of(change)
        front = replanned(task)
        points = np.array([change.point(way) for way in change.ways()])
        expected = points[nondominated(points.round(9))]
        np.testing.assert_allclose(front.points, expected, rtol=1e-9, err_msg=f"seed {seed}")
        found = ways(task, front, change)
        np.testing.assert_allclose([change.point(way) for way in found], front.points)
        assert front.kept is not None
        np.testing.assert_allclose(front.kept, [change.kept(way) for way in found])


def test_tours_that_keep_enough_are_no_worse_than_the_earlier_ones_that_do() -> None:
    for seed in range(third(40)):
        change = random_change(seed)
        task = task_of(change, min_kept=0.5)
        enough = [way for way in _completions(task, change) if change.kept(way) >= 0.5]
        if not enough:
            continue
        front = replanned(task)
        assert front.kept is not None
        assert (front.kept >= 0.5).all()
        for way in enough:
            no_worse = front.points <= np.array(change.point(way)) * (1 + 1e-9)
            assert no_worse.all(axis=1).any()


def test_a_share_that_no_tour_keeps_is_refused_with_the_most_that_one_does() -> None:
    rng = np.random.default_rng(3)
    instance = Instance(coordinates=rng.random((9, 4)))
    earlier = EarlierTours(np.array([[0, 4, 2, 5, 1, 3]]), min_kept=1.0)
    options = PlanOptions(directions=spread(1), fewer=True, size=9, time_limit=0.2)
    with pytest.raises(Refusal, match="at least 1 of the driven") as refused:
        replan(Shuffler(), instance, earlier, options)
    assert refused.value.code == "too-different"
    assert refused.value.actual is not None
    assert 0 <= refused.value.actual < 1


def _completions(task: Task, change: Change) -> list[tuple[int, ...]]:
    """The ways that the earlier tours become with what was added."""
    assert task.earlier is not None
    if not task.earlier.tours.shape[1]:
        return []
    tours = completed(instance_of(task), task.earlier)
    return ways(task, _FrontOf(tours), change)  # type: ignore[arg-type]


class _FrontOf:
    def __init__(self, tours: np.ndarray) -> None:
        self.tours = tours


def test_earlier_tours_are_completed_where_it_costs_least() -> None:
    rng = np.random.default_rng(5)
    for closed in (True, False):
        cities = rng.random((7, 4))
        instance = Instance(coordinates=cities, closed=closed, start=None if closed else 2)
        begun = np.array([[2, 0, 1, 3, 4, 5]])
        [tour] = completed(instance, EarlierTours(begun)).tolist()
        assert [city for city in tour if city != 6] == begun[0].tolist()
        steps = np.hypot(*(cities[:, None, :2] - cities[None, :, :2]).transpose(2, 0, 1))

        def length(way: list[int], steps: np.ndarray = steps, closed: bool = closed) -> float:
            return sum(steps[i, j] for i, j in zip(way, way[1:] + way[: int(closed)], strict=False))

        others = [[*begun[0, :k], 6, *begun[0, k:]] for k in range(1, 7)]
        assert length(tour) == pytest.approx(min(map(length, others)))


def test_fewer_tours_are_completed_where_all_would_take_too_long() -> None:
    instance = Instance(coordinates=np.random.default_rng(5).random((10, 4)))
    earlier = EarlierTours(np.array([np.roll(np.arange(6), k) for k in range(5)]))
    assert len(few_enough(instance, earlier, most=5 * 10 * 4).tours) == 5
    assert few_enough(instance, earlier, most=3 * 10 * 4).tours[:, 0].tolist() == [0, 4, 2]
    [driven] = few_enough(instance, earlier, most=1).tours
    assert driven.tolist() == earlier.driven.tolist()


def test_cities_that_are_not_touched_have_the_neighbours_and_costs_that_they_had() -> None:
    left_alone = 0
    for seed in range(third(60)):
        change = random_change(seed, least=7)
        task = task_of(change)
        assert task.earlier is not None
        tours = completed(instance_of(task), task.earlier)
        touched = touched_cities(instance_of(task), task.earlier, tours)
        [looked_at] = ways(task, _FrontOf(touched[np.newaxis]), change)  # type: ignore[arg-type]
        known = _neighbours(change)
        for way in ways(task, _FrontOf(tours), change):  # type: ignore[arg-type]
            for leg in change.legs(way):
                if set(leg) - set(looked_at):
                    assert frozenset(leg) in known
        for entry in change.request["costs"]:
            ends = [_index(change, entry[name]) for name in ("from", "to")]
            assert not set(ends) & set(ways(task, _FrontOf(tours), change)[0]) - set(looked_at)
        left_alone += tours.shape[1] - len(looked_at)
    assert left_alone > 0


def _neighbours(change: Change) -> set[frozenset[int]]:
    """The stops of a front that follow each other in one of its tours, or in the driven one."""
    closed = json.loads(change.front.source.body).get("closed", True)
    tours = change.front.found.orders.tolist()
    tours.append([change.ids.index(stop) for stop in change.request["tour"]])
    pairs = [
        pair for tour in tours for pair in zip(tour, tour[1:] + tour[: int(closed)], strict=False)
    ]
    return {frozenset(pair) for pair in pairs}


def _index(change: Change, stop: int | str) -> int:
    return stop if isinstance(stop, int) else change.ids.index(stop)


def test_of_tours_about_as_balanced_and_as_short_the_one_that_keeps_most_is_chosen() -> None:
    rng = np.random.default_rng(4)
    instance = Instance(coordinates=rng.random((9, 4)))
    tours = np.array([rng.permutation(9) for _ in range(4000)])
    tours = tours[nondominated(tour_lengths(instance, tours))]
    found = SearchResult(tour_lengths(instance, tours), tours.__getitem__, None)
    more, longer = 0, 0
    for driven in rng.permuted(np.tile(np.arange(9), (40, 1)), axis=1):
        balance = float(rng.random())
        chosen = np.sort(rng.permutation(len(tours))[: len(tours) // 3])
        instead = with_most_kept_at(instance, driven, balance, found, chosen)
        own = balances(found.points[chosen[0] : chosen[-1] + 1])
        away = dict(enumerate(np.abs(own - balance), start=chosen[0]))
        at = min(range(len(chosen)), key=lambda k: away[chosen[k]])
        others = np.delete(chosen, at)
        assert np.delete(instead, at).tolist() == others.tolist()
        kept = kept_shares(instance, tours, driven)
        if not 0 < at < len(chosen) - 1:
            assert instead[at] == chosen[at]
            continue
        nearer = [k for k in away if away[k] < min(away[other] for other in others)]
        width, height = found.points[chosen[at + 1]] - found.points[chosen[at - 1]]
        sums = found.points @ (-height, width)
        short = [k for k in nearer if sums[k] <= (1 + 1e-3) * min(sums[nearer])]
        assert kept[instead[at]] == max(kept[short])
        more += kept[instead[at]] > kept[chosen[at]]
        longer += len(short) < len(nearer)
    assert more > 0
    assert longer > 0


def test_of_equal_lengths_the_tour_most_like_the_driven_one_is_returned() -> None:
    """On a line in both planes, many routes have equal lengths."""
    line = np.repeat(np.arange(12.0)[:, np.newaxis] * 0, 4, axis=1)
    instance = Instance(coordinates=line, closed=False, start=0)
    driven = np.array([0, *np.random.default_rng(1).permutation(np.arange(1, 12))])
    options = PlanOptions(directions=spread(1), fewer=True, size=9, time_limit=0.2)
    front = replan(Shuffler(), instance, EarlierTours(driven[np.newaxis]), options)
    assert front.kept is not None
    assert front.kept.tolist() == [1.0]


def test_legs_count_in_one_direction_where_costs_differ_by_direction() -> None:
    matrices = np.arange(32.0).reshape(2, 4, 4)
    driven = np.array([0, 1, 2, 3])
    turned = np.array([[3, 2, 1, 0]])
    there = Instance(matrices=matrices)
    both = Instance(matrices=matrices + matrices.transpose(0, 2, 1))
    assert kept_shares(there, turned, driven).tolist() == [0.0]
    assert kept_shares(both, turned, driven).tolist() == [1.0]
