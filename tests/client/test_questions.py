"""Questions about a front, against enumeration: what each pick leaves within reach."""

from collections.abc import Iterator, Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from paretour.choice import WrongChoice
from paretour.questions import Option, Question, ask, representatives

from service.pareto import nondominated

# Small integers, so that ties are common.
LENGTHS = arrays(
    np.float64, st.tuples(st.integers(1, 30), st.integers(2, 4)), elements=st.integers(0, 9)
).map(lambda points: points[nondominated(points)])
FEW = {"questions": st.integers(1, 3), "options": st.integers(2, 4)}


def all_ends(
    lengths: np.ndarray, questions: int, options: int, picks: Sequence[int] = ()
) -> Iterator[tuple[Sequence[int], Question]]:
    """Every end that picks lead to."""
    asked = ask(lengths, picks, questions=questions, options=options)
    if asked.chosen is not None:
        yield picks, asked
    for pick in range(len(asked.options)):
        yield from all_ends(lengths, questions, options, [*picks, pick])


def within_reach(lengths: np.ndarray, option: Option) -> set[int]:
    """The numbers of the tours that are not longer than an option's point in any objective."""
    point = option.point.tolist()
    return {i for i, row in enumerate(lengths.tolist()) if all(map(float.__le__, row, point))}


def check_option(lengths: np.ndarray, option: Option, before: Option) -> None:
    """Check an option against the definitions, tour by tour."""
    inside = within_reach(lengths, option)
    assert option.within_reach == len(inside) > 0
    assert option.best.tolist() == [
        min(lengths[i, m] for i in inside) for m in range(len(option.point))
    ]
    assert inside <= within_reach(lengths, before)
    assert (option.point <= before.point).all()


@given(LENGTHS, FEW["questions"], FEW["options"])
def test_whatever_is_picked_no_objective_gets_worse_and_the_end_is_a_tour_within_reach(
    lengths: np.ndarray, questions: int, options: int
) -> None:
    for picks, end in all_ends(lengths, questions, options):
        assert len(picks) <= questions
        before = ask(lengths, questions=questions, options=options).current
        assert before.point.tolist() == lengths.max(axis=0).tolist()
        for number in range(len(picks)):
            asked = ask(lengths, picks[:number], questions=questions, options=options)
            assert asked.left == questions - number
            assert 2 <= len(asked.options) <= options
            for option in asked.options:
                check_option(lengths, option, asked.current)
        assert end.left == 0
        assert end.chosen in within_reach(lengths, end.current)
        if len(picks) == questions:
            assert end.current.point.tolist() == lengths[end.chosen].tolist()


@given(LENGTHS)
def test_one_question_with_an_option_for_each_tour_reaches_all(lengths: np.ndarray) -> None:
    ends = all_ends(lengths[:6], 1, 6)
    assert [end.chosen for _, end in ends] == list(range(len(lengths[:6])))


@pytest.mark.parametrize(
    ("objectives", "questions", "options", "most_unreached"),
    [(2, 3, 3, 80), (2, 4, 3, 65), (3, 3, 3, 84), (3, 3, 4, 67), (4, 3, 3, 83)],
)
def test_how_many_of_100_tours_no_picks_reach(
    objectives: int, questions: int, options: int, most_unreached: int
) -> None:
    if objectives == 2:
        angles = np.linspace(0, np.pi / 2, 100)
        directions = np.column_stack((np.cos(angles), np.sin(angles)))
    else:
        directions = np.abs(np.random.default_rng(0).normal(size=(100, objectives)))
    lengths = 1 - directions / np.linalg.norm(directions, axis=1, keepdims=True)
    reached = {end.chosen for _, end in all_ends(lengths, questions, options)}
    assert len(lengths) - len(reached) <= most_unreached


@given(LENGTHS, st.integers(0, 3), st.integers(-20, 20))
def test_the_unit_of_an_objective_does_not_matter(
    lengths: np.ndarray, objective: int, exponent: int
) -> None:
    other = lengths.copy()
    other[:, objective % lengths.shape[1]] *= 2.0**exponent
    ends, others = (list(all_ends(each, 2, 3)) for each in (lengths, other))
    assert [(p, e.chosen) for p, e in ends] == [(p, e.chosen) for p, e in others]


@given(LENGTHS, st.integers(1, 6))
def test_representatives_are_different_tours_as_many_as_there_are(
    lengths: np.ndarray, most: int
) -> None:
    lengths = np.concatenate((lengths, lengths + 1, lengths))
    different = {tuple(row) for row in lengths.tolist()}
    rows = [tuple(row) for row in lengths[representatives(lengths, most)].tolist()]
    assert len(set(rows)) == len(rows) == min(most, len(different))
    assert rows == sorted(rows)


FRONT = np.array([[2.0, 70.0], [3.0, 40.0], [6.0, 30.0]])


@pytest.mark.parametrize(
    ("lengths", "picks", "numbers", "sentence"),
    [
        (FRONT, [3], {}, "picks must each be the number of an option, here from 0 to 2, got 3"),
        (FRONT, [-1], {}, "picks must each be the number of an option, here from 0 to 2, got -1"),
        (FRONT, [0] * 4, {}, "picks must be at most 3, one a question, got 4"),
        (FRONT, [0, 0], {"questions": 1}, "picks must be at most 1, one a question, got 2"),
        (FRONT[:1], [0], {}, "picks must be at most 0, as one tour is left then, got 1"),
        (FRONT, [], {"questions": 11}, "questions must be from 1 to 10, got 11"),
        (FRONT, [], {"options": 1}, "options must be from 2 to 6, got 1"),
        (FRONT[:0], [], {}, "the front is empty yet"),
    ],
)
def test_wrong_picks_are_refused(
    lengths: np.ndarray, picks: list[int], numbers: dict[str, int], sentence: str
) -> None:
    with pytest.raises(WrongChoice) as refused:
        ask(lengths, picks, **numbers)
    assert str(refused.value) == sentence
