"""How many of many cases a run tries: the suite a sample of them, `python -m tests.nightly` all."""

import os
from collections.abc import Collection
from itertools import islice
from typing import TypeVar

import pytest

Case = TypeVar("Case")

WHOLE = "WHOLE_TESTS"  # the environment variable by which `python -m tests.nightly` asks for all
IS_WHOLE = WHOLE in os.environ

at_night = pytest.mark.skipif(not IS_WHOLE, reason="python -m tests.nightly runs it")


def tenth(count: int) -> int:
    """Return a tenth of a number of cases, or by night all of them."""
    return count if IS_WHOLE else max(1, count // 10)


def third(count: int) -> int:
    """Return a third of a number of seeds, or by night all of them."""
    return count if IS_WHOLE else max(1, count // 3)


def sixth(count: int) -> int:
    """Return a sixth of a number of seeds that take long, or by night all of them."""
    return count if IS_WHOLE else max(1, count // 6)


def few(count: int, cases: Collection[Case]) -> list[Case]:
    """Return the first of some cases, or by night all of them."""
    return list(cases if IS_WHOLE else islice(cases, count))
