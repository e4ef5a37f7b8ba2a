"""Images of an instance under the symmetries of a square, which a network sees anew each time."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from service.instance import OBJECTIVES, PLANE, Instance

MAX_SYMMETRIES = 8  # of a square


def symmetries(instance: Instance, count: int) -> Iterator[Instance]:
    """Yield the instance, then its images under `count` - 1 more of the 8 symmetries of a square.

    Tours have the same lengths in all of them. Both planes are mirrored and turned alike. An
    instance made from matrices is yielded once, whatever the count.
    """
    yield instance
    if instance.coordinates is None:
        return
    for number in range(1, count):
        planes = instance.coordinates.reshape(-1, OBJECTIVES, PLANE)
        mirrored = planes * np.where([number & 1, number & 2], -1.0, 1.0)
        turned = mirrored[..., ::-1] if number & 4 else mirrored
        yield replace(instance, coordinates=turned.reshape(-1, OBJECTIVES * PLANE))
