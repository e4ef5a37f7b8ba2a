"""Choose one tour of a front by a few questions: which of these, each better than before?

E-NAUTILUS (Ruiz, Sindhya, Miettinen, Ruiz and Luque, 2015) on a front that exists. It begins at
the worst length of every objective. Each question offers points between there and tours of the
front, and says the best that stays within reach from each. Who picks one gets better in every
objective, or stays as good, and gives nothing up. The last question offers tours of the front.

Nothing is stored: a question follows from the front, the picks so far, and how many questions and
options there are.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from paretour.choice import WrongChoice, losses
from paretour.described import Array, Lengths, answer, member
from paretour.expect import Members, count, each, value_of

Indices = NDArray[np.intp]
QUESTIONS = 3  # asked by default
MOST_QUESTIONS = 10
OPTIONS = 3  # offered by default
LEAST_OPTIONS, MOST_OPTIONS = 2, 6
_ROUNDS = 100  # of moving the middles of groups; a few are enough


@answer("OptionItem", kw_only=False)
class Option:
    """A point to stand on."""

    point: Lengths = member(
        "at the last question the lengths of a tour or plan; before, each is at least as good as"
        " where you stand"
    )
    best: Lengths = member("the least length of each objective within reach")
    within_reach: int = member("how many tours or plans exceed the point in no objective")


@dataclass(frozen=True, eq=False)
class Question:
    """Where the picks so far have led, and the options to pick from.

    Attributes:
        current: The option that was picked last; at first the worst length of every objective.
        left: How many questions are left, this one included; 0 at the end.
        options: The options by ascending first length; none at the end.
        chosen: The index of the chosen tour at the end; None before.
        document: The service's whole answer, if it asked the question: at the end with the tour.
    """

    current: Option
    left: int
    options: tuple[Option, ...] = ()
    chosen: int | None = None
    document: Mapping[str, Any] = field(default_factory=dict)


def ask(
    lengths: Array,
    picks: Sequence[int] = (),
    *,
    questions: int = QUESTIONS,
    options: int = OPTIONS,
) -> Question:
    """Return the question that follows some picks, or the tour that they have led to.

    The questions end early where a single tour is left within reach. Each takes O(k s m) times the
    rounds of grouping, for k tours and s options.

    Args:
        lengths: The lengths of a front's tours, shape (k, m), in any unit.
        picks: For each question so far, the index of the option that was picked.
        questions: How many questions there are, at most.
        options: How many options each has, at most.

    Raises:
        WrongChoice: A pick is not the index of an option, there are more picks than questions, a
            number is out of its bounds, or the front is empty.

    >>> front = np.array([[2.0, 70.0], [3.0, 40.0], [6.0, 30.0], [8.0, 28.0], [9.0, 20.0]])
    >>> [option.point.tolist() for option in ask(front, questions=2, options=2).options]
    [[6.0, 55.0], [8.5, 49.0]]
    >>> ask(front, [1], questions=2, options=2).left
    1
    >>> front[ask(front, [1, 0], questions=2, options=2).chosen].tolist()
    [3.0, 40.0]
    """
    _check("questions", questions, 1, MOST_QUESTIONS)
    _check("options", options, LEAST_OPTIONS, MOST_OPTIONS)
    if not len(lengths):
        raise WrongChoice("the front is empty yet")
    if len(picks) > questions:
        raise WrongChoice(f"must be at most {questions}, one a question, got {len(picks)}", "picks")
    question = _question(lengths, _option(lengths, lengths.max(axis=0)), questions, options)
    for number, pick in enumerate(picks):
        if question.chosen is not None:
            demand = f"must be at most {number}, as one tour is left then, got {len(picks)}"
            raise WrongChoice(demand, "picks")
        if not 0 <= pick < len(question.options):
            most = len(question.options) - 1
            demand = f"must each be the number of an option, here from 0 to {most}, got {pick}"
            raise WrongChoice(demand, "picks")
        question = _question(lengths, question.options[pick], question.left - 1, options)
    return question


def _question(lengths: Array, current: Option, left: int, options: int) -> Question:
    """Return the question at a point, with this many left, or the end."""
    inside = _inside(lengths, current.point)
    tours = inside[representatives(lengths[inside], options if left else 1)]
    if len(tours) == 1:
        return Question(current, 0, chosen=int(tours[0]))
    points = [_towards(lengths[tour], current.point, left) for tour in tours]
    return Question(current, left, tuple(_option(lengths, point) for point in points))


def _towards(tour: Array, point: Array, left: int) -> Array:
    """Return the point that is one of the steps left from a point to a tour, which it reaches."""
    return np.maximum(tour, point + (tour - point) / left) if left > 1 else tour


def _option(lengths: Array, point: Array) -> Option:
    """Return the option of standing on a point."""
    inside = _inside(lengths, point)
    return Option(point, lengths[inside].min(axis=0), len(inside))


def _inside(lengths: Array, point: Array) -> Indices:
    """Return the indices of the tours none of whose lengths exceeds the point's."""
    return np.flatnonzero((lengths <= point).all(axis=1))


def representatives(lengths: Array, most: int) -> Indices:
    """Return the indices of different tours that stand for all, by ascending lengths.

    Tours are put into groups around their middles (k-means, on losses), which begin far from each
    other. The tour nearest to the middle of its group stands for it. Of tours with equal lengths
    the first counts alone.

    Args:
        lengths: Shape (k, m), k at least 1.
        most: The number of tours to return, if there are as many.

    >>> representatives(np.array([[9.0, 0.0], [0.0, 9.0], [1.0, 8.0], [2.0, 7.0], [8.0, 1.0]]), 2)
    array([2, 4])
    """
    different, first = np.unique(lengths, axis=0, return_index=True)
    if len(different) <= most:
        return first
    scaled = losses(different)
    centres = _far_apart(scaled, most)
    for _ in range(_ROUNDS):
        group = _distances(scaled, scaled[centres]).argmin(axis=1)
        moved = np.array([_middle_of(scaled, group == each) for each in range(most)])
        if np.array_equal(moved, centres):
            break
        centres = moved
    return first[np.sort(centres)]


def _far_apart(points: Array, count: int) -> Indices:
    """Return the indices of points, the first one and then always the farthest from those."""
    chosen = [0]
    distance = _distances(points, points[:1])[:, 0]
    while len(chosen) < count:
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, _distances(points, points[chosen[-1:]])[:, 0])
    return np.array(chosen)


def _middle_of(points: Array, members: NDArray[np.bool_]) -> int:
    """Return the index of the member that is nearest to the mean of all members."""
    indices = np.flatnonzero(members)
    mean = points[indices].mean(axis=0, keepdims=True)
    return int(indices[_distances(points[indices], mean)[:, 0].argmin()])


def _distances(points: Array, others: Array) -> Array:
    """Return the squared distance of each point from each of the others."""
    return ((points[:, None] - others[None]) ** 2).sum(axis=2)


def parse_question(answer: Members) -> Question:
    """Return the question in a JSON answer of the service.

    Raises:
        UnexpectedAnswer: A member is missing or wrong.
    """
    return Question(
        current=value_of(Option)(answer.document, answer.where),
        left=answer.read("left", count),
        options=answer.read("options", each(value_of(Option))),
        chosen=answer.maybe("number", count),
        document=answer.document,
    )


def _check(parameter: str, number: int, least: int, most: int) -> None:
    if not least <= number <= most:
        raise WrongChoice(f"must be from {least} to {most}, got {number}", parameter)
