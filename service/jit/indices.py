"""Look up elements of arrays without asking whether an index counts from the end.

In Python an index of -1 is the last element. So numba compares every index with 0, which takes a
sixth of the time of a search. A function that creates no array is compiled without that: an index
that counts from the end is written there as a number, as in `tour[-1]`. With NUMBA_BOUNDSCHECK=1 an
index that is negative otherwise is an IndexError.
"""

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.np import arrayobj

_numba_fix_integer_index: Any = arrayobj.fix_integer_index


def _fix_integer_index(context: Any, builder: Any, kind: Any, index: Any, size: Any) -> Any:
    """Do as numba does if the function may create arrays, or the index is written as a number."""
    if context.enable_nrt or isinstance(_as_inserted(index), ir.Constant):
        return _numba_fix_integer_index(context, builder, kind, index, size)
    return context.cast(builder, index, kind, types.intp)


def _as_inserted(index: Any) -> Any:
    """Return an index of one of several dimensions as it was before a tuple was made of them."""
    if not isinstance(index, ir.instructions.ExtractValue):
        return index
    made = index.operands[0]
    while isinstance(made, ir.instructions.InsertValue):
        if made.indices == index.indices:
            return made.operands[1]
        made = made.operands[0]
    return index


def trust_indices() -> None:
    """Let functions that create no array look elements up so, from here on."""
    arrayobj.fix_integer_index = _fix_integer_index
