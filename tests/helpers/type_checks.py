"""Switch off the checks of types at run time, for the repetitions of what has been checked."""

from collections.abc import Iterator
from contextlib import contextmanager

from jaxtyping import config


@contextmanager
def unchecked_types() -> Iterator[None]:
    """Call functions without the checks of shapes, which take half of the time of small networks.

    For code that runs again and again with tensors of the same axes, after it ran once with them.
    """
    before = config.jaxtyping_disable
    config.update("jaxtyping_disable", True)
    try:
        yield
    finally:
        config.update("jaxtyping_disable", before)
