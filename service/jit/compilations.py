"""Follow numba's compilations, and prepare a process that others are forked from to compile."""

from functools import partial

from llvmlite.binding import ffi
from numba.core import config
from numba.core.event import Event, Listener, install_listener
from numba.core.registry import cpu_target

__all__ = ["Event", "Listener", "following_compilations", "import_compiler", "is_switched_off"]

following_compilations = partial(install_listener, "numba:compile")


def is_switched_off() -> bool:
    """Return whether functions are interpreted, because NUMBA_DISABLE_JIT says so."""
    return bool(config.DISABLE_JIT)  # type: ignore[attr-defined]  # set from the environment


def import_compiler() -> None:
    """Import all that numba compiles with; processes forked later share it."""
    cpu_target.target_context.refresh()
    ffi.lib._lock._cblist.clear()  # noqa: SLF001  # nobody asks how long numba calls LLVM
