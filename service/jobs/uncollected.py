"""Let Python's garbage collector wait while modules and compiled code are loaded.

What is loaded stays. To look through it again and again takes a sixth of the time.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def uncollected() -> Iterator[None]:
    """Collect no garbage until the end of the block."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            if not gc.get_freeze_count():  # what the program froze stays frozen
                gc.freeze()  # all goes to the oldest generation, where it is not looked through now
                gc.unfreeze()
            gc.enable()
