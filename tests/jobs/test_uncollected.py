"""The garbage collector waits while what stays is loaded, and is as it was afterwards."""

import gc
import weakref
from collections.abc import Iterator

import pytest

from service.jobs.uncollected import uncollected


@pytest.fixture
def collections() -> Iterator[list[int]]:
    """The generations that are collected during a test."""
    collected: list[int] = []

    def note(phase: str, info: dict[str, int]) -> None:
        if phase == "start":
            collected.append(info["generation"])

    gc.unfreeze()  # what the tests themselves have frozen
    gc.callbacks.append(note)
    yield collected
    gc.callbacks.remove(note)


def test_what_was_loaded_is_not_looked_through(collections: list[int]) -> None:
    with uncollected():
        loaded = [[k] for k in range(100_000)]
    loaded.append([0])
    assert collections == []
    assert gc.isenabled()
    assert gc.get_freeze_count() == 0


def test_it_is_collected_later_like_anything_else() -> None:
    class Garbage(list[object]):
        """Takes weak references and cycles."""

    ended: list[str] = []
    with uncollected():
        garbage = Garbage()
        garbage.append(garbage)
        weakref.finalize(garbage, ended.append, "garbage")
        del garbage
    gc.collect()
    assert ended == ["garbage"]


@pytest.mark.parametrize("enabled", [True, False])
def test_what_a_program_froze_or_switched_off_stays_so(enabled: bool) -> None:
    gc.freeze()
    try:
        if not enabled:
            gc.disable()
        with uncollected():
            pass
        assert gc.isenabled() == enabled
        assert gc.get_freeze_count() > 0
    finally:
        gc.enable()
        gc.unfreeze()
