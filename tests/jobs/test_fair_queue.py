"""The queue of submissions: whose turn it is."""

import asyncio
from collections.abc import Sequence

import pytest
from hypothesis import example, given

from service.jobs.fair_queue import FairQueue
from service.jobs.submission import Submission
from tests.helpers.scripted_runner import task
from tests.helpers.turns import EVENTS, clients_by_policy


def take_next(queue: FairQueue[Submission], served: Sequence[str] = ()) -> Submission:
    """Take the submission whose turn it is."""
    following = queue.next(served)
    assert following is not None
    queue.take(following)
    return following


def turns(before: str, then: str, taken: int = 1, served: Sequence[str] = ()) -> str:
    """Return the clients in the order of their turns, a letter for each submission.

    Args:
        before: The clients of submissions that wait first.
        then: Those of submissions that come when some have had their turn.
        taken: How many have had it by then.
        served: The clients for which one is being run, from then on.
    """

    async def take() -> str:
        queue = FairQueue[Submission]()
        for number, client in enumerate(before):
            queue.append(Submission(number, task(), lambda: None, client))
        order = [take_next(queue).client for _ in range(taken)]
        for number, client in enumerate(then, len(before)):
            queue.append(Submission(number, task(), lambda: None, client))
        while len(queue):
            order.append(take_next(queue, served).client)
        return "".join(order)

    return asyncio.run(take())


@pytest.mark.parametrize(
    ("before", "then", "order"),
    [
        ("aaaa", "b", "abaaa"),  # the crowd had its turn just before, and one who comes had none
        ("a", "aab", "abaa"),  # also where nothing of the crowd waited any more
        ("aaab", "cc", "abcaca"),
        ("aabb", "", "abab"),
    ],
)
def test_the_next_is_of_the_client_whose_turn_is_longest_ago(
    before: str, then: str, order: str
) -> None:
    assert turns(before, then, 2 if then == "cc" else 1) == order


def test_a_client_that_is_served_waits_behind_those_that_are_not() -> None:
    assert turns("ab", "aabb", 2, served="a") == "abbbaa"


@given(events=EVENTS)
@example("aaa.b.-.c..")
def test_turns_follow_the_policy(events: str) -> None:
    async def take() -> str:
        queue, running, turns = FairQueue[Submission](), list[str](), ""
        for number, event in enumerate(events):
            if event == "-":
                del running[:1]
            elif event != ".":
                queue.append(Submission(number, task(), lambda: None, event))
            elif len(queue):
                running.append(take_next(queue, running).client)
                turns += running[-1]
        return turns

    assert asyncio.run(take()) == clients_by_policy(events)


def test_who_cannot_be_served_yet_is_overtaken_and_keeps_the_turn() -> None:
    async def take() -> list[int]:
        queue = FairQueue[Submission]()
        for number, client in enumerate("aab"):
            queue.append(Submission(number, task(), lambda: None, client))
        order = []
        for unable in ({0}, {0}, set[int]()):
            following = queue.next(able=lambda each, unable=unable: each.number not in unable)
            assert following is not None
            queue.take(following)
            order.append(following.number)
        assert queue.next() is None
        return order

    assert asyncio.run(take()) == [1, 2, 0]


def test_turns_of_many_clients_take_little_memory() -> None:
    async def take() -> int:
        queue = FairQueue[Submission]()
        for number in range(3000):
            submission = Submission(number, task(), lambda: None, str(number))
            queue.append(submission)
            queue.take(submission)
        return len(queue._turns)

    assert asyncio.run(take()) == 1000
