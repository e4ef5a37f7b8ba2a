"""Operations on tuples of tensors that share the rows of a problem: each tensor is treated alike.

A member of a tuple may be None, and stays None.
"""

from collections.abc import Callable, Iterable, Sequence
from operator import itemgetter
from typing import Any, TypeVar

import torch
from jaxtyping import Float
from torch import Tensor

Rows = TypeVar("Rows", bound=tuple[Any, ...])  # a NamedTuple


def stacked(parts: Sequence[Rows], dim: int = 0) -> Rows:
    """Return all parts, concatenated by rows or along another dimension."""
    members = zip(*parts, strict=True)
    return _made(
        type(parts[0]), (each[0] if each[0] is None else torch.cat(each, dim) for each in members)
    )


def repeated(rows: Rows, times: int) -> Rows:
    """Return each row several times, one copy after the other."""
    return changed(rows, lambda member: member.repeat_interleave(times, dim=0))


def split(rows: Rows, count: int) -> list[Rows]:
    """Return as many parts of equally many rows, into which the rows must divide."""
    size = len(rows[0]) // count
    return [changed(rows, itemgetter(slice(i * size, (i + 1) * size))) for i in range(count)]


def changed(rows: Rows, change: Callable[[Tensor], Tensor]) -> Rows:
    """Return the tuple with every member that there is changed."""
    return _made(type(rows), (member if member is None else change(member) for member in rows))


def side_by_side(numbers: Float[Tensor, "*x"], count: Any) -> Float[Tensor, "*x count"]:
    """Return each number `count` times: an integer, while a network is exported a tensor of one.

    Exported, a product takes less time than to repeat numbers, or to let them spread.
    """
    return numbers[..., None] @ numbers.new_ones(1, count)


# A NamedTuple takes its members one by one, which the bound on its type does not express.
def _made(kind: Callable[..., Rows], members: Iterable[Any]) -> Rows:
    return kind(*members)
