"""Ask until a front has several plans: short searches on a busy machine may find one."""

from collections.abc import Callable
from typing import Any

import pytest

_TRIES = 20


def with_several_plans(ask: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """Return the first answer of several whose front has more than one plan; fail without one."""
    for _ in range(_TRIES):
        answer = ask()
        if len(answer["front"]) > 1:
            return answer
    pytest.fail(f"{_TRIES} searches found one plan each")
