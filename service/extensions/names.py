"""Name the extensions that a service uses."""

from typing import NamedTuple


class Extensions(NamedTuple):
    """The names of the constructors, and of the search that takes the place of Paretour's."""

    constructors: tuple[str, ...] = ()
    search: str | None = None


NO_EXTENSIONS = Extensions()
