"""Name the parts of a request as its caller wrote it, where it was rewritten before its check."""

from collections.abc import Callable
from copy import copy
from dataclasses import replace
from typing import NamedTuple

from service.errors.exceptions import Refusal
from service.errors.faults import Fault
from service.errors.tours import CityNames

_STOPS = "stops"


class Part(NamedTuple):
    """A part of a request: its name in sentences, and its pointer if the request has it."""

    name: str
    pointer: str | None


Rename = Callable[[str], Part]


def part_of(path: str) -> Part:
    """Return a part that the request has, as add/0/window."""
    return Part(path, f"/{path}")


def renamed(refusal: Refusal, rename: Rename) -> Refusal:
    """Return a refusal whose faults name parts of the body as `rename` does."""
    errors = [_renamed(fault, rename) for fault in refusal.errors]
    if errors == [*refusal.errors]:
        return refusal
    if refusal.code == "invalid-request":
        return Refusal(refusal.code, errors=errors)
    found = copy(refusal)
    found.errors = tuple(errors)
    return found


def by_stop(refusal: Refusal, names: CityNames) -> Refusal:
    """Return a refusal that names stops/3 as the request does, or by its id if it has no such part.

    Args:
        refusal: The refusal of what a request was rewritten to.
        names: The names of the stops that its parts count, and their pointers.
    """

    def rename(path: str) -> Part:
        head, _, rest = path.partition("/")
        number, _, member = rest.partition("/")
        if head != _STOPS or not number:
            return part_of(path)
        pointer = names.pointer(int(number))
        if pointer is not None:
            return part_of(f"{pointer[1:]}/{member}" if member else pointer[1:])
        stop = names.of([int(number)])
        return Part(f"{member} of {stop}" if member else stop, None)

    return renamed(refusal, rename)


def _renamed(fault: Fault, rename: Rename) -> Fault:
    path = fault.part if fault.pointer is None else fault.pointer[1:]
    if path is None or fault.parameter is not None:
        return fault
    name, pointer = rename(path)
    other = fault.values.get("other")
    values = fault.values
    if isinstance(other, str) and other.startswith("/"):
        values = {**values, "other": f"/{rename(other[1:]).name}"}
    part = None if fault.part is None else name
    return replace(fault, part=part, pointer=pointer, values=values)
