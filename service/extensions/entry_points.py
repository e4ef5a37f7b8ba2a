"""Find functions that other packages register as entry points, and import those that are named.

A package registers a function in the group `paretour.constructors` or `paretour.searches`. Its
function is imported only if the operator names it.
"""

from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points
from typing import Any

CONSTRUCTORS = "paretour.constructors"
SEARCHES = "paretour.searches"
_VARIABLES = {CONSTRUCTORS: "PARETOUR_CONSTRUCTORS", SEARCHES: "PARETOUR_SEARCH"}
_KINDS = {CONSTRUCTORS: "constructor", SEARCHES: "search"}


def entry_point(group: str, name: str) -> EntryPoint:
    """Return the entry point with a name, without importing its package.

    Raises:
        ValueError: No installed package, or more than one, has such an entry point.
    """
    found = entry_points(group=group, name=name)
    if len(found) != 1:
        installed = ", ".join(sorted(entry_points(group=group).names)) or "none"
        demand = f"must name entry points of the group {group}, each of one package"
        raise ValueError(f"{_VARIABLES[group]} {demand}, got {name}; installed: {installed}")
    [only] = found
    return only


def loaded(group: str, name: str) -> Callable[..., Any]:
    """Import the package of an entry point, and return the function.

    Raises:
        ValueError: The entry point is not installed, cannot be imported, or is not a function.
    """
    found = entry_point(group, name)
    try:
        function = found.load()
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise ValueError(f"{described(group, name)} must be importable: {reason}") from error
    if not callable(function):
        raise ValueError(f"{described(group, name)} must be a function, got {function!r:.100}")
    return function


def source(found: EntryPoint) -> str:
    """Return the name and version of an entry point's package; "" if they are not known."""
    return "" if found.dist is None else f"{found.dist.name} {found.dist.version}"


def described(group: str, name: str) -> str:
    """Return an entry point in words, such as "search mine of my-package 1.0", for messages."""
    return f"{_KINDS[group]} {name} of {source(entry_point(group, name))}"
