"""The rest of a way through stops: its task, over random changes, and what is refused where."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from paretour.choice import balances

from service.errors import Refusal
from service.kinds.parsing import parse_replan
from service.requests.limits import Limits
from service.requests.replan.way import MOST_TOURS, ReplanSource, StoredFront
from service.requests.stops import Stops, cost_matrices
from service.requests.task import Task, TaskSource
from tests.helpers.actors import info_of
from tests.helpers.changes import Change, Found, FrontOf, front_of, random_change
from tests.helpers.sampled import third

LIMITS = Limits(body_bytes=2**20, cities=50, cells=100, preferences=99, size=9999, seconds=9)
INFOS = {kind: info_of(kind, kind) for kind in ("coordinates", "matrices")}
CITIES = np.random.default_rng(1).integers(0, 9, (6, 4)).tolist()
TOURS = [[0, 1, 2, 3, 4, 5], [0, 2, 1, 3, 5, 4], [0, 5, 1, 4, 2, 3]]
LENGTHS = [[1.0, 9.0], [2.0, 3.0], [9.0, 1.0]]  # the second is the knee
PLANES = {"coordinates": CITIES}
MATRICES = {"matrices": np.random.default_rng(2).integers(1, 9, (2, 6, 6)).tolist()}
NAMED = {
    "stops": [{"id": f"s{i}", "location": [25.0 + i / 100, 60.0]} for i in range(6)],
    "objectives": [
        {"name": "way", "from": "great_circle"},
        {"name": "risk", "matrix": MATRICES["matrices"][1]},
    ],
}
HERE = [24.9, 60.1]
RISK = {"to": [1.0] * 7}
NEW = {"id": "new", "location": HERE, "costs": [None, RISK]}


def stored(request: dict[str, Any], tours: Any = TOURS, lengths: Any = LENGTHS) -> FrontOf:
    source = TaskSource("front", json.dumps(request).encode())
    return front_of(source, Found(np.array(tours), np.array(lengths)))


def rest(front: StoredFront, limits: Limits = LIMITS, **request: Any) -> Task:
    body = json.dumps(request).encode()
    return parse_replan(ReplanSource(body, front), limits, INFOS)


def task_of(change: Change, **more: object) -> Task:
    return rest(change.front, **{**change.request, "size": 9999, **more})


def stops_of(task: Task) -> Stops:
    assert isinstance(task.subject, Stops)
    return task.subject


def test_the_rest_has_the_stops_costs_ends_and_tour_that_are_left() -> None:
    for seed in range(third(300)):
        change = random_change(seed)
        task = task_of(change)
        stops, labels = stops_of(task), task.labels
        assert labels is not None
        index = [change.ids.index(stop.id) for stop in labels.stops]
        ends = {stop for stop in (change.start, change.end) if stop is not None}
        assert set(index) == {*change.between, *ends}
        assert len(set(index)) == len(index)
        costs = change.costs[:, index][:, :, index]
        np.testing.assert_allclose(cost_matrices(stops), costs, err_msg=f"seed {seed}")
        assert stops.ends.closed == change.back
        if not change.back:
            fixed = [None if end is None else index[end] for end in stops.ends[1:]]
            assert fixed == [change.start, change.end]
        elif change.start is not None:
            assert index[task.options.start] == change.start
        assert task.earlier is not None
        assert [index[city] for city in task.earlier.driven] == change.driven


def test_what_is_not_changed_is_that_of_the_front() -> None:
    for request in (PLANES, MATRICES, NAMED):
        whole = rest(stored(request))
        assert stops_of(whole).n == 6
        assert whole.earlier is not None
        # The first is the one being driven, by default the knee.
        assert whole.earlier.tours.tolist() == [TOURS[1], *TOURS]
        assert whole.earlier.touched is not None
        again = parse_replan(ReplanSource(b"{}", stored(request)), LIMITS, INFOS)
        np.testing.assert_array_equal(
            cost_matrices(stops_of(again)), cost_matrices(stops_of(whole))
        )


def test_the_options_are_those_of_the_request_and_not_of_the_front() -> None:
    front = stored({**PLANES, "time_limit": 5.0, "seed": 7, "size": 3})
    task = rest(front, time_limit=2.5, seed=9, size=4, min_kept=0.25, actor="coordinates")
    assert (task.options.time_limit, task.options.seed, task.options.size) == (2.5, 9, 4)
    assert task.earlier is not None
    assert task.earlier.min_kept == 0.25
    assert task.actor == "coordinates"
    assert rest(front).options.time_limit != 5.0


def test_a_changed_cost_makes_a_front_in_planes_one_of_matrices() -> None:
    entry = {"objective": 1, "from": 2, "to": 4, "cost": 77.0}
    task = rest(stored(PLANES), costs=[entry])
    assert task.actor == "matrices"
    before = cost_matrices(stops_of(rest(stored(PLANES))))
    after = cost_matrices(stops_of(task))
    assert after[1, 2, 4] == 77
    assert np.argwhere(after != before).tolist() == [[1, 2, 4]]


def test_of_changes_of_one_cost_the_last_counts_and_null_closes_a_way() -> None:
    def entry(cost: float | None, **names: Any) -> dict[str, Any]:
        return {"objective": "risk", "from": "s1", "to": "s2", "cost": cost, **names}

    one, two, closed = entry(3.0), entry(5.0, **{"from": 1}), entry(None, to="s3", objective=0)
    costs = cost_matrices(stops_of(rest(stored(NAMED), costs=[one, closed, two])))
    assert (costs[1, 1, 2], costs[0, 1, 3]) == (5, np.inf)


def test_added_stops_come_behind_those_of_the_front_and_the_position_last() -> None:
    rows = [{"to": [i + 1.0] * 8, "from": [i + 10.0] * 8} for i in range(2)]
    add = {"id": "new", "costs": rows}
    here = {"id": "here", "costs": [{"to": [7.0] * 8}, {"to": [8.0] * 8}]}
    task = rest(stored(MATRICES), add=[add], position=here, remove=[3], done=[1])
    assert task.labels is not None
    assert [stop.id for stop in task.labels.stops] == ["0", "2", "4", "5", "new", "here"]
    costs = cost_matrices(stops_of(task))
    assert costs[:, 4, :4].tolist() == [[1.0] * 4, [2.0] * 4]
    assert costs[:, :4, 4].tolist() == [[10.0] * 4, [11.0] * 4]
    # Between two new stops `to` counts; without `from` it is the same.
    assert (costs[0, 4, 5], costs[0, 5, 4]) == (1, 7)
    assert costs[:, :4, 5].tolist() == [[7.0] * 4, [8.0] * 4]
    assert stops_of(task).ends == (False, 5, 0)


def test_a_closed_tour_that_has_begun_leads_from_the_last_done_back_to_its_start() -> None:
    task = rest(stored(PLANES), done=[0, 2, 1], tour=TOURS[1])
    assert task.labels is not None
    assert [stop.id for stop in task.labels.stops] == ["0", "1", "3", "4", "5"]
    assert stops_of(task).ends == (False, 1, 0)
    assert task.earlier is not None
    assert task.earlier.driven.tolist() == [1, 2, 4, 3, 0]


def test_a_tour_whose_last_stops_are_done_is_driven_the_other_way_round() -> None:
    task = rest(stored(PLANES), done=[0, 5, 4], tour=TOURS[0])
    assert task.labels is not None
    assert task.earlier is not None
    driven = [task.labels.stops[city].id for city in task.earlier.driven]
    assert driven == ["4", "3", "2", "1", "0"]


def test_no_more_tours_of_the_front_are_taken_than_the_search_has_weights() -> None:
    rng = np.random.default_rng(3)
    tours = [[0, *rng.permutation(range(1, 6)).tolist()] for _ in range(120)]
    lengths = [[1.0 + i, 120.0 - i] for i in range(120)]
    task = rest(stored(PLANES, tours, lengths))
    assert task.earlier is not None
    assert len(task.earlier.tours) == 1 + MOST_TOURS
    assert task.earlier.tours[[1, -1]].tolist() == [tours[0], tours[-1]]


def changed(**entry: Any) -> dict[str, Any]:
    return {"costs": [{"objective": 0, "from": 1, "to": 2, "cost": 1, **entry}]}


@pytest.mark.parametrize(
    ("front", "request_", "pointer", "detail"),
    [
        (NAMED, {"done": ["s9"]}, "/done/0", "must be the id of a stop"),
        (NAMED, {"done": ["s0 "]}, "/done/0", 'did you mean "s0"'),
        (NAMED, {"done": [6]}, "/done/0", "must be a stop of the front, 0 to 5, got 6"),
        (NAMED, {"done": [1, "s1"]}, "/done/1", "must not be done/0 again"),
        (NAMED, {"tour": ["s0"] * 6}, "/tour/1", "must not be tour/0 again"),
        (NAMED, {"tour": ["s0"]}, "/tour", "must have all 6 stops of the front, got 1"),
        (NAMED, {"remove": ["s0"]}, "/remove/0", "must not be where the way goes on"),
        (
            NAMED,
            {"add": [{**NEW, "id": "s3"}]},
            "/add/0/id",
            "must differ from the ids of all other stops",
        ),
        (NAMED, {"add": [NEW, NEW]}, "/add/1/id", "must differ from the ids of all other stops"),
        (
            NAMED,
            {"add": [NEW], "position": NEW},
            "/position/id",
            "must differ from the ids of all other",
        ),
        (NAMED, {"add": [[0, 0]]}, "/add/0", "must be a stop with an id"),
        (NAMED, {"add": [{**NEW, "location": None}]}, "/add/0/location", '"way" is measured'),
        (
            NAMED,
            {"add": [{**NEW, "costs": [None, None]}]},
            "/add/0/costs",
            'with an entry for "risk"',
        ),
        (
            NAMED,
            {"add": [{**NEW, "costs": [RISK, RISK]}]},
            "/add/0/costs/0",
            'must be null: "way" is measured',
        ),
        (
            NAMED,
            {"add": [{**NEW, "costs": [None, {"to": [1.0] * 6}]}]},
            "/add/0/costs/1/to",
            "must have 7 costs",
        ),
        (
            NAMED,
            {"add": [{**NEW, "costs": [None, {"to": [1.0] * 7, "from": [1.0]}]}]},
            "/add/0/costs/1/from",
            "must have 7 costs",
        ),
        (
            MATRICES,
            {"add": [{"id": "new", "coordinates": [[0, 0], [0, 0]]}]},
            "/add/0/costs",
            "is required",
        ),
        (
            PLANES,
            {"add": [{"id": "new", "coordinates": [[0, 0], None]}]},
            "/add/0/coordinates",
            'with an entry for "second"',
        ),
        (NAMED, changed(objective="cost"), "/costs/0/objective", 'must be 0, 1 or "way" or "risk"'),
        (NAMED, changed(to="s1"), "/costs/0/to", "must not be the stop that the step leads from"),
        (NAMED, changed(**{"from": 6}), "/costs/0/from", "must be a stop of the front, 0 to 5"),
        (NAMED, {"objectives": NAMED["objectives"][:1]}, "/objectives", "must have 2 items"),
        (
            NAMED,
            {"objectives": NAMED["objectives"], "add": [NEW]},
            "/add/0/costs",
            "must not be given together with objectives",
        ),
        (
            NAMED,
            {"objectives": NAMED["objectives"], "add": [{"id": "n", "location": HERE}]},
            "/objectives/1/matrix",
            "must have 7 rows",
        ),
        (NAMED, {"blocked": [[0, 0]]}, "/blocked", "must be left out"),
        (NAMED, {"pose": [0.0, 0.0]}, "/pose", "must be left out"),
        (PLANES, {"size": 10_000}, "/size", "must be at most"),
        (PLANES, {"time_limit": 10}, "/time_limit", "must be at most 9"),
        (PLANES, {"min_kept": -0.1}, "/min_kept", "at least 0"),
        (PLANES, {"closed": False}, "/closed", "is not a field"),
        ({**PLANES, "closed": False}, {"done": [*range(6)], "remove": [5]}, "/remove/0", "done"),
        (
            {**PLANES, "closed": False, "start": 0, "end": 5},
            {"done": [0, 5]},
            "/done/1",
            "must not be where the way ends while stops are left",
        ),
        (
            {**PLANES, "closed": False, "start": None},
            {"remove": [*range(6)]},
            "/remove",
            "must leave a stop to visit",
        ),
    ],
)
def test_what_cannot_be_is_refused_at_its_place(
    front: dict[str, Any], request_: dict[str, Any], pointer: str, detail: str
) -> None:
    with pytest.raises(Refusal) as refused:
        rest(stored(front), **request_)
    assert refused.value.errors[0].pointer == pointer, refused.value.detail
    assert detail in refused.value.detail


@pytest.mark.parametrize("body", [b"", b"[]", b"{", b'{"done": [1}', b'{"min_kept": NaN}', b"\xff"])
def test_a_body_that_is_no_request_is_refused(body: bytes) -> None:
    with pytest.raises(Refusal) as refused:
        parse_replan(ReplanSource(body, stored(PLANES)), LIMITS, INFOS)
    assert refused.value.status in (400, 422)


def test_more_stops_than_the_kind_of_their_costs_allows_are_refused_by_what_makes_them_so() -> None:
    few = replace(LIMITS, matrix_cities=3)
    front = stored({"coordinates": np.eye(4).tolist()}, [[0, 1, 2, 3]], [[4.0, 4.0]])
    entry = {"objective": 0, "from": 1, "to": 2, "cost": 1.0}
    objectives = [{"name": name, "matrix": [[1] * 4] * 4} for name in "ab"]
    rest(front, few)
    for change, part in (({"costs": [entry]}, "costs"), ({"objectives": objectives}, "objectives")):
        with pytest.raises(Refusal) as refused:
            rest(front, few, **change)
        assert (refused.value.code, refused.value.limit) == ("too-many-cities", 3)
        assert refused.value.errors[0].pointer == f"/{part}"


def test_new_objectives_may_have_touched_every_city() -> None:
    change = random_change(0)
    first, second = change.costs.tolist()
    objectives = [{"name": "a", "matrix": first}, {"name": "b", "matrix": second}]
    places = [{"id": each["id"]} for each in change.request["add"]]
    task = task_of(change, objectives=objectives, add=places, position=None, costs=[])
    assert task.earlier is not None
    assert task.earlier.touched is None


def test_the_driven_tour_has_the_balance_that_it_had_in_the_earlier_front() -> None:
    for seed in range(third(40)):
        change = random_change(seed)
        found = change.front.found
        driven = [change.ids.index(stop) for stop in change.request["tour"]]
        orders = found.orders.tolist()
        ways = [np.roll(tour, -tour.index(driven[0])).tolist() for tour in orders]
        expected = balances(found.lengths)[ways.index(driven)]
        earlier = task_of(change).earlier
        assert earlier is not None
        assert earlier.balance == expected


def test_a_driven_tour_that_was_not_in_the_earlier_front_has_no_balance() -> None:
    change = random_change(1, least=7)
    swapped = [*change.request["tour"][:-3], *change.request["tour"][:-4:-1]]
    earlier = task_of(change, tour=swapped).earlier
    assert earlier is not None
    assert earlier.balance is None
