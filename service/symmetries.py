"""The same cities seen otherwise: turned and mirrored, for networks that see coordinates."""

from collections.abc import Iterator

import numpy as np

from service.instance import Instance

MOST = 8  # of a square


def symmetries(instance: Instance, count: int) -> Iterator[Instance]:
    """The instance itself, and then as it looks under others of the eight symmetries of a square.

    All have the same tours and the same lengths. Both planes are mirrored alike. Of matrices there
    is one view.
    """
    yield instance
    if instance.coordinates is None:
        return
    for number in range(1, count):
        planes = instance.coordinates.reshape(-1, 2, 2)
        mirrored = planes * np.where([number & 1, number & 2], -1.0, 1.0)
        turned = mirrored[..., ::-1] if number & 4 else mirrored
        yield Instance(coordinates=turned.reshape(-1, 4))
