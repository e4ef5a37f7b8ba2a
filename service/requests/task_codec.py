"""Tasks as bytes: the one form in which they are stored, queued and sent to other machines.

The bytes are a line with the version, the length of the header, the header, and the arrays one
after another as .npy. The header is JSON: the members of the task. In it the number of an array
stands for the array, and a dataclass of a task comes with the name of its type.
"""

import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from io import BytesIO
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray
from pydantic_core import from_json, to_json

from service.instance import RouteEnds
from service.requests.task import Task

_FIRST_LINE = b"paretour task 4\n"
_LENGTH = struct.Struct("!Q")


def _annotations_in(annotation: Any) -> Iterator[Any]:
    """Yield an annotation, and those inside it and in the members of its dataclasses."""
    yield annotation
    is_class = is_dataclass(annotation)
    inside = get_type_hints(annotation).values() if is_class else get_args(annotation)
    for each in inside:
        yield from _annotations_in(each)


_ANNOTATIONS = tuple(_annotations_in(Task))
_TYPES: Mapping[str, type[Any]] = {
    each.__name__: each for each in _ANNOTATIONS if isinstance(each, type) and is_dataclass(each)
}
# The dataclasses that stand in tuples of any length: a task may hold thousands of their values.
# Their own members are numbers, texts, and tuples of numbers.
_FLAT_TYPES: Mapping[str, type[Any]] = {
    of.__name__: of
    for each in _ANNOTATIONS
    if get_origin(each) is tuple and isinstance(of := get_args(each)[0], type) and is_dataclass(of)
}
_NUMBERS = "biuf"  # kinds of NumPy's types: booleans, integers and floats

Arrays = list[NDArray[Any]]


def encode_task(task: Task) -> bytes:
    """Return a task as bytes."""
    arrays: Arrays = []
    header = to_json(_encoded(task, arrays), inf_nan_mode="constants")
    content = BytesIO()
    content.write(_FIRST_LINE + _LENGTH.pack(len(header)) + header)
    for array in arrays:
        np.lib.format.write_array(content, array, allow_pickle=False)
    return content.getvalue()


def decode_task(content: bytes) -> Task:
    """Return the task that `encode_task` wrote.

    Raises:
        ValueError: The bytes are damaged, or of another version.
    """
    if not content.startswith(_FIRST_LINE):
        raise ValueError("the task is of another version")
    begin = len(_FIRST_LINE) + _LENGTH.size
    try:
        (length,) = _LENGTH.unpack_from(content, len(_FIRST_LINE))
        arrays = list(_arrays(content, begin + length))
        task = _decoded(from_json(content[begin : begin + length]), arrays)
    # Damaged bytes may make these parsers raise any exception.
    except Exception as error:
        raise ValueError(f"the task is damaged: {error!r}") from error
    if not isinstance(task, Task):
        raise ValueError(f"the task is a {type(task).__name__}")
    return task


def _encoded(value: Any, arrays: Arrays) -> Any:
    """Return a value ready for JSON, and append its arrays to these."""
    if isinstance(value, np.ndarray):
        return {"$array": _number_of(value, arrays)}
    if isinstance(value, RouteEnds):
        return {"$ends": list(value)}
    if isinstance(value, tuple | list):
        return _encoded_sequence(value, arrays)
    if isinstance(value, dict):
        return {"$mapping": {key: _encoded(each, arrays) for key, each in value.items()}}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    name = type(value).__name__
    if _TYPES.get(name) is not type(value):
        raise TypeError(f"a task has no values of type {name}")
    members = {each.name: getattr(value, each.name) for each in fields(value)}
    return {"$type": name, **{key: _encoded(each, arrays) for key, each in members.items()}}


def _number_of(value: NDArray[Any], arrays: Arrays) -> int:
    """Return the number of an array, which is appended unless it is one of these."""
    if value.dtype.kind not in _NUMBERS:
        raise TypeError(f"an array must be of numbers, got {value.dtype}")
    for number, array in enumerate(arrays):
        if array is value:
            return number
    arrays.append(value)
    return len(arrays) - 1


def _encoded_sequence(values: Sequence[Any], arrays: Arrays) -> Any:
    name = type(values[0]).__name__ if values else ""
    if name in _FLAT_TYPES:
        return {"$rows": [list(vars(each).values()) for each in values], "$of": name}
    return [_encoded(each, arrays) for each in values]


def _decoded(value: Any, arrays: Sequence[NDArray[Any]]) -> Any:
    """Return the value that `_encoded` made ready for JSON; its sequences become tuples."""
    if isinstance(value, list):
        return tuple(_decoded(each, arrays) for each in value)
    if not isinstance(value, dict):
        return value
    if "$array" in value:
        return arrays[value["$array"]]
    if "$ends" in value:
        return RouteEnds(*value["$ends"])
    if "$mapping" in value:
        return {key: _decoded(each, arrays) for key, each in value["$mapping"].items()}
    if "$rows" in value:
        flat = _FLAT_TYPES[value["$of"]]
        names = [each.name for each in fields(flat)]
        # Members that a row of an earlier version lacks have their defaults.
        return tuple(
            flat(**dict(zip(names[: len(row)], map(_tuples, row), strict=True)))
            for row in value["$rows"]
        )
    members = {k: _decoded(each, arrays) for k, each in value.items() if k != "$type"}
    return _TYPES[value["$type"]](**members)


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


def _arrays(content: bytes, begin: int) -> Iterator[NDArray[Any]]:
    """Yield the arrays of a task; the first one begins at this byte."""
    stream = BytesIO(content)
    stream.seek(begin)
    while stream.tell() < len(content):
        array: NDArray[Any] = np.lib.format.read_array(stream, allow_pickle=False)
        yield array
