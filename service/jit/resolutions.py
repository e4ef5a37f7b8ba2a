"""Remember which implementation of an operator fits given types: numba asks again at each use.

For each `+` of a kernel numba tries its implementations of `+`, one after another, until one takes
the types. It notes under which options it has compiled those, and compares the options each time,
one by one. Without both a kernel is compiled in five sixths of the time, to the same code.
"""

from typing import Any

from numba.core.compiler import Flags
from numba.core.target_extension import get_local_target
from numba.core.targetconfig import ConfigStack
from numba.core.types.functions import BaseFunction

_Function: Any = BaseFunction  # it has no types
_Flags: Any = Flags

_DEFAULTS = {name: option.default for name, option in _Flags.options.items()}
_numba_resolve = _Function.get_call_type
_numba_equal = _Flags.__eq__
# By function, target, types and options. The function is kept, so that no other one has its id.
_resolved: dict[tuple[Any, ...], tuple[Any, Any, Any]] = {}


def _resolve(function: Any, context: Any, arguments: Any, named: Any) -> Any:
    """Return the signature of an implementation that takes arguments, or raise, as numba does.

    With it, the function notes the implementation; under other options that is another one.
    """
    options = ConfigStack.top_or_none()
    target = get_local_target(context)
    call = id(function), context, target, tuple(arguments), tuple(named.items())
    if (known := _resolved.get((*call, options))) is not None:
        _, signature, implementation = known
        function._impl_keys[signature.args] = implementation  # noqa: SLF001  # it has no setter
        return signature
    signature = _numba_resolve(function, context, arguments, named)
    # numba may change the options later.
    kept = None if options is None else options.copy()
    _resolved[*call, kept] = function, signature, function.get_impl_key(signature)
    return signature


def _equal(options: Any, others: object) -> bool:
    """Return whether two sets of options have the same values, set or by default."""
    if not (type(options) is type(others) is Flags):
        return bool(_numba_equal(options, others))
    set_here, set_there = options._values, others._values  # noqa: SLF001  # it has no getter
    if set_here.keys() == set_there.keys():
        return bool(set_here == set_there)
    return {**_DEFAULTS, **set_here} == {**_DEFAULTS, **set_there}


def _hash(_: Any) -> int:
    """Return the same number for all options, as numba does, which takes long to find it."""
    return hash(Flags)


def resolve_once() -> None:
    """Let numba remember what it has resolved, from here on."""
    _Function.get_call_type = _resolve
    _Flags.__eq__ = _equal
    _Flags.__hash__ = _hash
