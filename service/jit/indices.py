"""Look up elements of arrays without asking whether an index counts from the end.

In Python an index of -1 is the last element. So numba compares every index with 0, which takes a
sixth of the time of a search. A function that creates no array is compiled without that: an index
that counts from the end is written there as a number, as in `tour[-1]`. With NUMBA_BOUNDSCHECK=1 an
index that is negative otherwise is an IndexError.
"""

from contextvars import ContextVar
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.np import arrayobj

_numba_fix_integer_index: Any = arrayobj.fix_integer_index
_trusting = ContextVar("trusting", default=False)  # whether a kernel is being compiled


def trust_indices(kernel: Any) -> None:
    """Let the dispatcher of a function that creates no array compile it so.

    Not that of one that does: functions of numba that it calls may create none.
    """
    compile_core = kernel._compiler._compile_core  # noqa: SLF001  # numba has no option for it

    def compile_trusting(*given: Any) -> Any:
        token = _trusting.set(True)
        try:
            return compile_core(*given)
        finally:
            _trusting.reset(token)

    kernel._compiler._compile_core = compile_trusting  # noqa: SLF001  # as above


def _fix_integer_index(context: Any, builder: Any, kind: Any, index: Any, size: Any) -> Any:
    """Do as numba does, unless the function is a kernel and the index is not written as a number.

    Functions that are compiled because a kernel calls them may create arrays.
    """
    trusted = _trusting.get() and not context.enable_nrt
    if trusted and not isinstance(_as_inserted(index), ir.Constant):
        return context.cast(builder, index, kind, types.intp)
    return _numba_fix_integer_index(context, builder, kind, index, size)


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


arrayobj.fix_integer_index = _fix_integer_index
