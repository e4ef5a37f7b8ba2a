"""The operations of a JSON patch (RFC 6902) that remedies need."""

from typing import Any, Literal, NotRequired, TypedDict


class Operation(TypedDict):
    """An operation on a member of an object."""

    op: Literal["add", "remove"]
    path: str
    value: NotRequired[Any]


def put(path: str, value: object) -> Operation:
    """Return the operation that gives a member a value, whether it had one or not."""
    return {"op": "add", "path": path, "value": value}


def remove(path: str) -> Operation:
    """Return the operation that removes a member, which must be there."""
    return {"op": "remove", "path": path}
