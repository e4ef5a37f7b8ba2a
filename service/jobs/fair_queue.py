"""A queue that takes submissions, or whatever else clients wait for, in turn by client."""

from collections import deque
from collections.abc import Callable, Container, Iterator
from itertools import chain, count
from typing import Generic, Protocol, TypeVar

_REMEMBERED = 1000  # clients whose latest turn is remembered


class _OfClient(Protocol):
    @property
    def client(self) -> str: ...


Item = TypeVar("Item", bound=_OfClient)


class FairQueue(Generic[Item]):
    """Waiting submissions, which clients have planned in turn.

    Clients without a running submission come first. Of these a newcomer is next, the earliest if
    there are several, then the client whose latest turn is longest ago. The workers of a cluster
    follow the same policy, in `service/cluster/records.lua`.
    """

    def __init__(self) -> None:
        self._first: deque[Item] = deque()
        self._by_client: dict[str, deque[Item]] = {}
        self._turns: dict[str, int] = {}  # the number of each client's latest turn, ascending
        self._numbers = count()

    def __len__(self) -> int:
        """Return how many wait."""
        return len(self._first) + sum(map(len, self._by_client.values()))

    def __iter__(self) -> Iterator[Item]:
        """Iterate over those that wait, client by client."""
        return chain(self._first, *self._by_client.values())

    def append(self, submission: Item) -> None:
        """Add a submission behind those of the same client."""
        self._by_client.setdefault(submission.client, deque()).append(submission)

    def put_first(self, submission: Item) -> None:
        """Add a submission before all others."""
        self._first.appendleft(submission)

    def next(
        self, served: Container[str] = (), able: Callable[[Item], bool] = lambda _: True
    ) -> Item | None:
        """Return the next submission, which stays; None if none waits that can be run.

        Args:
            served: The clients with a running submission.
            able: Returns whether the worker can run a submission.
        """
        for submission in filter(able, self._first):
            return submission
        firsts = (next(filter(able, waiting), None) for waiting in self._by_client.values())
        return min(
            (first for first in firsts if first is not None),
            key=lambda each: (each.client in served, self._turns.get(each.client, -1)),
            default=None,
        )

    def take(self, submission: Item) -> None:
        """Remove a waiting submission to run it: a turn of its client, unless it was put first."""
        if submission not in self._first:
            self._note_turn(submission.client)
        self.remove(submission)

    def _note_turn(self, client: str) -> None:
        self._turns.pop(client, None)
        self._turns[client] = next(self._numbers)
        if len(self._turns) > _REMEMBERED:
            del self._turns[next(iter(self._turns))]

    def remove(self, submission: Item) -> None:
        """Remove a submission, if it waits."""
        if submission in self._first:
            self._first.remove(submission)
        waiting = self._by_client.get(submission.client, deque())
        if submission in waiting:
            waiting.remove(submission)
            if not waiting:
                del self._by_client[submission.client]
