"""Windows in which requests are counted: how many pass, and how long the others have to wait."""

import asyncio

from hypothesis import given
from hypothesis import strategies as st

from service.api.rates.windows import MovingWindow, SlidingWindow

Hits = list[tuple[float, str]]


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


def waits(kind: type[MovingWindow] | type[SlidingWindow], hits: Hits) -> list[float | None]:
    """How long each caller has to wait that comes at these times, where 2 in 10 s are allowed."""

    async def run() -> list[float | None]:
        clock = Clock()
        window = kind(2, 10, clock)
        found = []
        for clock.now, caller in hits:
            found.append(await window.hit(caller))
        return found

    return asyncio.run(run())


def test_in_a_moving_window_a_request_counts_for_its_seconds_exactly() -> None:
    hits = [(8, "a"), (9, "a"), (9, "b"), (11, "a"), (18, "a"), (18, "a"), (19, "a")]
    assert waits(MovingWindow, hits) == [None, None, None, 7, None, 1, None]


def test_in_a_sliding_window_those_of_the_window_before_count_by_their_share() -> None:
    hits = [(8, "a"), (9, "a"), (9, "b"), (9, "a"), (10, "a"), (12, "a"), (12, "a"), (17, "a")]
    assert waits(SlidingWindow, hits) == [None, None, None, 1, 0, None, 3, None]


def test_in_a_sliding_window_those_of_earlier_windows_do_not_count() -> None:
    hits = [(8, "a"), (9, "a"), (25, "a"), (26, "a"), (27, "a")]
    assert waits(SlidingWindow, hits) == [None, None, None, None, 3]


@given(
    gaps=st.lists(st.integers(0, 6), min_size=1, max_size=30),
    kind=st.sampled_from([MovingWindow, SlidingWindow]),
)
def test_who_is_told_to_wait_passes_afterwards(
    gaps: list[int], kind: type[MovingWindow] | type[SlidingWindow]
) -> None:
    hits = [(float(sum(gaps[: i + 1])), "a") for i in range(len(gaps))]
    wait = waits(kind, hits)[-1]
    if wait is not None:
        assert 0 <= wait <= 10
        assert waits(kind, [*hits, (hits[-1][0] + wait + 1e-6, "a")])[-1] is None
