"""Build tours with a function of another package, in place of a network."""

import hashlib
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from service.actor_info import ActorInfo
from service.construction.call_estimate import CallEstimate
from service.extensions.checks import called, checked
from service.extensions.entry_points import CONSTRUCTORS, described, entry_point, loaded, source
from service.instance import Instance
from service.objectives import MOST_OBJECTIVES

Array = NDArray[np.float64]
Tours = NDArray[np.int64]


class ExternalConstructor:
    """A function of another package that builds tours, with the methods of a network.

    Args:
        name: The name of its entry point.

    Raises:
        ValueError: The function is not installed, or cannot be imported.
    """

    def __init__(self, name: str) -> None:
        self.info = constructor_infos([name])[name]
        self.estimate = CallEstimate(self.info.inputs)
        self._function = loaded(CONSTRUCTORS, name)

    def load(self) -> None:
        """Do nothing: the function is imported already."""

    def tours(self, instance: Instance, preferences: Array, repairs: int = 0) -> Tours:  # noqa: ARG002
        """Return the tours that the function builds, one for each preference, shape (k, n).

        Args:
            instance: The instance with n cities and m objectives.
            preferences: Shape (k, m).
            repairs: Not used: a function has no repairs.

        Raises:
            Refusal: The function raised, or did not return such tours.
        """
        found = called(self._function, instance, preferences)
        return checked(found, instance, described(CONSTRUCTORS, self.info.name), len(preferences))

    def terminate(self) -> None:
        """Do nothing: the function cannot be stopped."""


def load_constructors(
    names: Iterable[str], taken: Iterable[str] = ()
) -> dict[str, ExternalConstructor]:
    """Import constructors, and return them by their names.

    Args:
        names: The names of their entry points.
        taken: The names of networks, which a constructor must not have.

    Raises:
        ValueError: One is not installed, cannot be imported, or has a taken name.
    """
    names = tuple(names)
    constructor_infos(names, taken)
    return {name: ExternalConstructor(name) for name in names}


def constructor_infos(names: Iterable[str], taken: Iterable[str] = ()) -> Mapping[str, ActorInfo]:
    """Return the descriptions of constructors by their names, without importing them.

    Args:
        names: The names of their entry points.
        taken: The names of networks, which a constructor must not have.

    Raises:
        ValueError: One is not installed, or has a taken name.
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
            # With "matrices" it may plan every instance: a function gets the instance as a whole.
            inputs="matrices",
            sizes=[],
            angles=[],
            config={},
            figures={},
            most_objectives=MOST_OBJECTIVES,
        )
    return infos
