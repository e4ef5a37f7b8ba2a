"""The tour that a query of `GET /tour` chooses, against a search through all tours."""

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
    angle, others = query.get("angle"), {k: v for k, v in query.items() if k != "angle"}
    if expected is not None:
        assert asked.choose(points, directions) == expected
        assert choose(points, directions, angle, others) == expected
        return
    with pytest.raises(Refusal) as refused:
        asked.choose(points, directions)
    [(name, budget)] = query.items()
    least = points[:, 0 if name == "first_at_most" else 1].min()
    assert (refused.value.code, refused.value.limit) == ("no-such-tour", budget)
    assert refused.value.actual == least > budget
    with pytest.raises(ValueError, match=f"the least is {least:g}"):
        choose(points, directions, angle, others)


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
