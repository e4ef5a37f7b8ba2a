"""Build tours with a function of another package, in the place of a network."""

import hashlib
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from service.actor_info import ActorInfo
from service.construction.call_estimate import CallEstimate
from service.extensions.checks import called, checked
from service.extensions.entry_points import (
    CONSTRUCTORS,
    described,
    entry_point,
    loaded,
    source,
)
from service.instance import Instance
from service.objectives import MOST_OBJECTIVES

Array = NDArray[np.float64]
Tours = NDArray[np.int64]


class Constructor:
    """A function of another package that builds tours, in the place of a network.

    Raises:
        ValueError: It is not installed, or cannot be imported.
    """

    def __init__(self, name: str) -> None:
        self.info = constructor_infos([name])[name]
        self.estimate = CallEstimate(self.info.inputs)
        self._function = loaded(CONSTRUCTORS, name)

    def load(self) -> None:
        """Do nothing: it was imported when it was made."""

    def tours(self, instance: Instance, preferences: Array, repairs: int = 0) -> Tours:  # noqa: ARG002
        """Return the function's tours, shape (k, n), one a preference (k, m).

        Raises:
            Refusal: It failed, or returned other than that.
        """
        found = called(self._function, instance, preferences)
        return checked(found, instance, described(CONSTRUCTORS, self.info.name), len(preferences))

    def terminate(self) -> None:
        """Do nothing: the function cannot be told to stop."""


def load_constructors(names: Iterable[str], taken: Iterable[str] = ()) -> dict[str, Constructor]:
    """Return the constructors of these names.

    Raises:
        ValueError: One is not installed, cannot be imported, or its name is taken.
    """
    names = tuple(names)
    constructor_infos(names, taken)
    return {name: Constructor(name) for name in names}


def constructor_infos(names: Iterable[str], taken: Iterable[str] = ()) -> Mapping[str, ActorInfo]:
    """Return what is known of constructors before they are imported, by name.

    Raises:
        ValueError: One is not installed, or a network has its name.
    """
    infos = {}
    for name in names:
        if name in taken:
            raise ValueError(
                f"PARETOUR_CONSTRUCTORS must not have the name of a network, got {name}"
            )
        found = entry_point(CONSTRUCTORS, name)
        package = source(found)
        infos[name] = ActorInfo(
            name=name,
            digest=hashlib.sha256(f"{package} {found.value}".encode()).hexdigest(),
            commit=package,
            inputs="matrices",  # which serve both kinds: a function is given the whole instance
            sizes=[],
            angles=[],
            config={},
            figures={},
            most_objectives=MOST_OBJECTIVES,
        )
    return infos
