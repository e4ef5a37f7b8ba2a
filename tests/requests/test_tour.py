"""The tour that a query of `GET /tour` chooses, against a search through all tours."""

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from paretour.choice import choose

from service.errors import Refusal
from service.pareto import nondominated
from service.preferences import angles
from service.requests.tour import TourQuery

FRONTS = arrays(
    np.float64, st.tuples(st.integers(1, 12), st.just(2)), elements=st.integers(0, 20)
).map(lambda points: points[nondominated(points)])
QUERIES = (
    st.fixed_dictionaries({"angle": st.floats(0, 90)})
    | st.fixed_dictionaries({"balance": st.floats(0, 1)})
    | st.fixed_dictionaries({"first_at_most": st.integers(0, 25)})
    | st.fixed_dictionaries({"second_at_most": st.integers(0, 25)})
    | st.just({"knee": True})
)


def best(points: np.ndarray, query: dict[str, Any]) -> int | None:
    """The index that a plain search finds; None where no tour is within the budget."""
    (u0, v0), (u1, v1) = points.min(axis=0), points.max(axis=0)
    worst: list[tuple[float, int]] = []
    for index, (first, second) in enumerate(points.tolist()):
        u = (first - u0) / ((u1 - u0) or 1)
        v = (second - v0) / ((v1 - v0) or 1)
        match query:
            case {"angle": angle}:
                worst.append((abs(float(angles(points[[index]], np.ones(2))[0]) - angle), index))
            case {"balance": balance}:
                worst.append((abs((u + 1 - v) / 2 - balance), index))
            case {"first_at_most": budget} if first <= budget:
                worst.append((second, index))
            case {"second_at_most": budget} if second <= budget:
                worst.append((first, index))
            case {"knee": True}:
                worst.append((u + v, index))
    return min(worst)[1] if worst else None


@given(FRONTS, QUERIES)
def test_service_and_client_choose_what_a_plain_search_finds(
    points: np.ndarray, query: dict[str, Any]
) -> None:
    asked = TourQuery(**query)
    asked.check()
    expected = best(points, query)
    directions = angles(points, np.ones(2))
    if expected is not None:
        assert asked.choose(points, directions) == expected
        assert choose(points, directions, [], query) == expected
        return
    with pytest.raises(Refusal) as refused:
        asked.choose(points, directions)
    [(name, budget)] = query.items()
    least = points[:, 0 if name == "first_at_most" else 1].min()
    assert (refused.value.code, refused.value.limit) == ("no-such-tour", budget)
    assert refused.value.actual == least > budget
    with pytest.raises(ValueError, match=f"the least is {least:g}"):
        choose(points, directions, [], query)


@pytest.mark.parametrize(
    ("query", "came"),
    [
        ({}, "none"),
        ({"front": "f"}, "none"),
        ({"knee": False}, "none"),
        ({"angle": 0, "balance": 0}, "angle and balance"),
        ({"first_at_most": 1, "knee": True}, "first_at_most and knee"),
    ],
)
def test_exactly_one_way_must_be_given(query: dict[str, Any], came: str) -> None:
    with pytest.raises(Refusal, match=f"must be given, got {came}$"):
        TourQuery(**query).check()


def several(objectives: int) -> st.SearchStrategy[np.ndarray]:
    """Fronts with this number of objectives."""
    shape = st.tuples(st.integers(1, 12), st.just(objectives))
    points = arrays(np.float64, shape, elements=st.integers(0, 20))
    return points.map(lambda each: each[nondominated(each)])


def number_of_each(objectives: int, most: int) -> st.SearchStrategy[dict[int, int]]:
    """Numbers for some objectives."""
    index = st.integers(0, objectives - 1)
    return st.dictionaries(index, st.integers(1, most), min_size=1)


def parts(numbers: dict[int, int], names: list[str]) -> list[str]:
    """Numbers as a query has them: by name where the index is even, else by index."""
    return [f"{names[k] if k % 2 == 0 else k}:{number}" for k, number in numbers.items()]


@pytest.mark.parametrize("objectives", [2, 3, 4])
@given(data=st.data())
def test_weights_choose_the_least_of_the_greatest_loss(
    objectives: int, data: st.DataObject
) -> None:
    points = data.draw(several(objectives))
    weights = data.draw(number_of_each(objectives, 9))
    names = [f"way, {k}:" for k in range(objectives)]
    least, most = points.min(axis=0), points.max(axis=0)
    found = []
    for index, point in enumerate(points):
        loss = [
            weight * ((point[k] - least[k]) / ((most[k] - least[k]) or 1))
            for k, weight in weights.items()
        ]
        found.append((max(loss), sum(loss), index))
    query = TourQuery(weights=parts(weights, names))
    query.check()
    nowhere = np.full(len(points), np.nan)
    assert query.choose(points, nowhere, names) == min(found)[2]
    assert choose(points, nowhere, names, {"weights": weights}) == min(found)[2]


@pytest.mark.parametrize("objectives", [2, 3, 4])
@given(data=st.data())
def test_budgets_choose_the_least_of_the_objective_preferred(
    objectives: int, data: st.DataObject
) -> None:
    points = data.draw(several(objectives))
    budgets = data.draw(number_of_each(objectives, 30))
    prefer = data.draw(st.integers(0, objectives - 1))
    names = [f"way {k}" for k in range(objectives)]
    within = [
        (point[prefer], index)
        for index, point in enumerate(points)
        if all(point[k] <= budget for k, budget in budgets.items())
    ]
    query = TourQuery(at_most=parts(budgets, names), prefer=names[prefer])
    query.check()
    nowhere = np.full(len(points), np.nan)
    if within:
        assert query.choose(points, nowhere, names) == min(within)[1]
        choice = {"at_most": budgets, "prefer": prefer}
        assert choose(points, nowhere, names, choice) == min(within)[1]
        return
    with pytest.raises(Refusal) as refused:
        query.choose(points, nowhere, names)
    assert refused.value.code == "no-such-tour"
    assert refused.value.actual > refused.value.limit


@pytest.mark.parametrize(
    ("members", "sentence"),
    [
        (
            {"weights": ["time"]},
            "weights must be a name, a colon and a number that is not negative",
        ),
        ({"weights": ["time:-1"]}, "that is not negative"),
        ({"weights": ["time:nan"]}, "that is not negative"),
        ({"weights": ["cost:1"]}, 'weights must name one of "0", "1", "2", "time"'),
        ({"weights": ["time:0,1:0"]}, "weights must have one that is more than 0"),
        ({"weights": ["time:1,0:2"]}, "weights must have each objective once"),
        ({"at_most": ["3:1"]}, "at_most must name one of"),
        ({"at_most": ["time:9"]}, "prefer is required, as 2 objectives have no limit"),
        ({"at_most": ["time:9"], "prefer": "cost"}, "prefer must name one of"),
        ({"angle": 30}, "angle is for fronts of two objectives"),
        ({"balance": 0.5}, "balance is for fronts of two objectives"),
        ({"first_at_most": 9}, "first_at_most is for fronts of two objectives"),
    ],
)
def test_what_is_not_a_choice_is_refused(members: dict[str, Any], sentence: str) -> None:
    query = TourQuery(**members)
    query.check()
    with pytest.raises(Refusal, match=re.escape(sentence)):
        query.choose(np.eye(3) + 1, np.full(3, np.nan), ["time", "risk", "way"])


def test_what_is_preferred_needs_a_limit() -> None:
    with pytest.raises(Refusal, match="prefer is for a choice by at_most alone"):
        TourQuery(knee=True, prefer="time").check()
