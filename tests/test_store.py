"""Fronts kept for later, and how they make way."""

import pytest

from service.store import Expired, Store, Unknown


class Clock:
    """A clock that is told the time."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def test_what_was_put_is_given_again() -> None:
    store: Store[int] = Store(entries=2, max_age=60)
    store.put("a", 1)
    store.put("b", 2)
    assert (store.get("a"), store.get("b"), store.latest()) == (1, 2, 2)


def test_a_key_never_used_is_unknown() -> None:
    store: Store[int] = Store(entries=2, max_age=60)
    with pytest.raises(Unknown):
        store.get("a")
    with pytest.raises(Unknown):
        store.latest()


def test_the_oldest_makes_way_when_the_store_is_full() -> None:
    store: Store[int] = Store(entries=2, max_age=60)
    for number, key in enumerate("abc"):
        store.put(key, number)
    with pytest.raises(Expired):
        store.get("a")
    assert (store.get("b"), store.get("c")) == (1, 2)


def test_asking_for_a_front_does_not_keep_it_longer() -> None:
    clock = Clock()
    store: Store[int] = Store(entries=2, max_age=60, clock=clock)
    store.put("a", 1)
    clock.now = 60
    assert store.get("a") == 1
    clock.now = 61
    with pytest.raises(Expired):
        store.get("a")
    with pytest.raises(Expired):
        store.latest()


def test_only_so_many_of_the_gone_are_remembered() -> None:
    store: Store[int] = Store(entries=1, max_age=60, tombstones=2)
    for number, key in enumerate("abcd"):
        store.put(key, number)
    with pytest.raises(Unknown):
        store.get("a")
    for key in "bc":
        with pytest.raises(Expired):
            store.get(key)
