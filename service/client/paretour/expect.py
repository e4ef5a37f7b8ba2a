"""Read JSON answers member by member, each as the type that the client expects.

An object becomes a dataclass, by the types of its fields (`value_of`). A wrong member raises
UnexpectedAnswer, with a sentence that names the member, what it must be, and what came. Other
members are ignored, so a later service may have more of them.
"""

import json
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, Field, dataclass, fields
from datetime import datetime
from functools import cache, partial
from itertools import chain
from reprlib import Repr
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray
from paretour.described import Shape, name_of, shape_of

T = TypeVar("T")
Read = Callable[[Any, str], T]  # from a value and its name in sentences to the value as its type
AnyArray = TypeVar("AnyArray", bound=NDArray[Any])
_GREATEST = sys.float_info.max
_COUNTS = 2**53  # counts and indexes are less: JSON numbers are exact up to here in all languages
_SHOWN = Repr()
_SHOWN.maxlevel, _SHOWN.maxlist, _SHOWN.maxdict, _SHOWN.maxstring = 2, 3, 3, 60


class UnexpectedAnswer(Exception):
    """An answer that this service would not give: it is broken, or from another program."""


def unexpected(where: str, demand: str, value: Any) -> UnexpectedAnswer:
    """Return the exception for a value that is not as demanded."""
    return UnexpectedAnswer(f"{where} must be {demand}, got {_SHOWN.repr(value)}")


@dataclass(frozen=True)
class Members:
    """The members of a JSON object, to be read one by one.

    Attributes:
        document: The object.
        where: Its name in sentences, as `front/0`.
    """

    document: Mapping[str, Any]
    where: str

    def read(self, name: str, read: Read[T]) -> T:
        """Return a required member."""
        if name not in self.document:
            raise UnexpectedAnswer(f"{self.where} must have a member {name}, got none")
        return read(self.document[name], f"{self.where}/{name}")

    def maybe(self, name: str, read: Read[T]) -> T | None:
        """Return a member, or None where it is missing or null."""
        value = self.document.get(name)
        return None if value is None else read(value, f"{self.where}/{name}")


def parse_json(content: str | bytes, where: str) -> Members:
    """Return the members of the JSON object in a text, or in bytes of UTF-8."""
    try:
        text = content if isinstance(content, str) else content.decode("utf-8-sig")
        document = json.loads(
            text,
            object_pairs_hook=_without_repeats,
            parse_float=_finite,
            parse_constant=_finite,
        )
    except (ValueError, RecursionError) as error:
        start = _SHOWN.repr(content[:60])
        raise UnexpectedAnswer(f"{where} must be JSON, got {start}: {error}") from None
    return members(document, where)


def _without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    document = dict(pairs)
    if len(document) != len(pairs):
        raise ValueError("an object names a member twice")
    return document


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError("a number is not finite")
    return value


def members(value: Any, where: str) -> Members:
    """Read an object."""
    if type(value) is not dict and not isinstance(value, Mapping):  # the latter takes a while
        raise unexpected(where, "an object", value)
    return Members(value, where)


def text(value: Any, where: str) -> str:
    """Read text."""
    try:
        value.encode()
    except (AttributeError, UnicodeEncodeError):  # "\ud800" alone is not a character
        raise unexpected(where, "text", value) from None
    return value


def flag(value: Any, where: str) -> bool:
    """Read true or false."""
    if not isinstance(value, bool):
        raise unexpected(where, "true or false", value)
    return value


def number(value: Any, where: str) -> float:
    """Read a finite number."""
    if type(value) not in (int, float) or not -_GREATEST <= value <= _GREATEST:
        raise unexpected(where, "a finite number", value)
    return value


def count(value: Any, where: str) -> int:
    """Read a whole number from 0."""
    if type(value) is not int or not 0 <= value < _COUNTS:
        raise unexpected(where, "a whole number from 0", value)
    return value


def anything(value: Any, _where: str) -> Any:
    """Read a value without checking it."""
    return value


def time(value: Any, where: str) -> datetime:
    """Read a time."""
    try:
        return datetime.fromisoformat(text(value, where))
    except ValueError:
        raise unexpected(where, "a time of RFC 3339", value) from None


def each(read: Read[T], length: int | None = None) -> Read[tuple[T, ...]]:
    """Return a reader of lists whose items `read` reads; all of this length, if one is given."""

    def read_list(value: Any, where: str) -> tuple[T, ...]:
        if not isinstance(value, list) or length not in (None, len(value)):
            raise unexpected(where, f"a list{_items(length)}", value)
        return tuple(read(item, f"{where}/{i}") for i, item in enumerate(value))

    return read_list


def floats(*shape: int | None) -> Read[NDArray[np.float64]]:
    """Return a reader of arrays of finite numbers, of one or two dimensions; None is any length."""

    def read(value: Any, where: str) -> NDArray[np.float64]:
        array = _array(value, where, (int, float), np.float64, shape)
        if not np.isfinite(array).all():
            raise unexpected(where, "finite numbers", value)
        return array

    return read


def indexes(*shape: int | None, below: int = _COUNTS) -> Read[NDArray[np.int64]]:
    """Return a reader of arrays of whole numbers from 0; None is any length."""

    def read(value: Any, where: str) -> NDArray[np.int64]:
        array = _array(value, where, (int,), np.int64, shape)
        if array.size and not 0 <= array.min() <= array.max() < below:
            most = "" if below == _COUNTS else f" to {below - 1}"
            raise unexpected(where, f"whole numbers from 0{most}", value)
        return array

    return read


def rows(
    items: Sequence[Members], name: str, reader: Callable[..., Read[NDArray[Any]]], width: int
) -> NDArray[Any]:
    """Return a member of all items, lists of numbers of one width, as the rows of an array.

    Args:
        reader: `floats` or `indexes`.
        width: The length of each list.
    """
    return _at_once(items, name, reader(None, width), reader(width))


def column(items: Sequence[Members], name: str) -> NDArray[np.float64]:
    """Return a member of all items, a number, as an array."""
    return _at_once(items, name, floats(None), number)


def optional_column(
    items: Sequence[Members], cls: type, name: str, known: Mapping[str, Any]
) -> Any:
    """Return a member of all items; numbers, and lists of these, as an array.

    Args:
        cls: The dataclass of one, which says what the member is.
        known: Of the members before it, by name, something of the same length.

    Returns:
        None if the first item has none.
    """
    if not items or items[0].document.get(name) is None:
        return None
    [(of, shaped)] = [(of, shaped) for field, _, of, shaped in _fields(cls) if field.name == name]
    if float in (of, *get_args(of)):
        return column(items, name)
    if shaped and shaped[0] in _ARRAYS and len(shaped[1].sizes) == 1:
        return rows(items, name, _ARRAYS[shaped[0]], *shaped[1].after(known))
    reader = _shaped(*shaped, known) if shaped else _reader(of)
    return tuple(item.read(name, reader) for item in items)


def _at_once(
    items: Sequence[Members], name: str, every: Read[AnyArray], one: Read[Any]
) -> AnyArray:
    """Return a member of all items, which are read at once: one by one takes several times as long.

    If something is wrong, they are read one by one, to say which of them it is.
    """
    try:
        return every([item.document.get(name) for item in items], name)
    except UnexpectedAnswer:
        for item in items:
            item.read(name, one)
        raise


def _array(
    value: Any, where: str, types: tuple[type, ...], dtype: type, shape: Sequence[int | None]
) -> Any:
    """Return numbers of these types as a read-only array of this shape.

    Lists are flattened and their types checked before NumPy sees them: it would accept text as
    numbers.
    """
    length, *width = shape
    rows = value if width else [value]
    numbers = list(chain.from_iterable(rows)) if _are_lists(rows, *(width or [length])) else None
    if (
        numbers is None
        or (width and length not in (None, len(rows)))
        or not set(map(type, numbers)) <= set(types)
    ):
        kind = "numbers" if float in types else "whole numbers"
        pairs = f" lists of {width[0]}" if width else ""
        raise unexpected(where, f"a list{_items(length)} of{pairs} {kind}", value)
    try:
        array = np.array(numbers, dtype=dtype)
    except OverflowError:
        raise unexpected(where, "numbers of 64 bits", value) from None
    return read_only(array.reshape(len(rows), *width) if width else array)


def _are_lists(rows: Any, length: int | None) -> bool:
    """Return whether rows are a list of lists, of one length if that is given."""
    if not isinstance(rows, list) or not set(map(type, rows)) <= {list}:
        return False
    return length is None or set(map(len, rows)) <= {length}


def _items(length: int | None) -> str:
    return "" if length is None else f" of length {length}"


def read_only(array: AnyArray) -> AnyArray:
    """Make an array read-only, and return it."""
    array.setflags(write=False)
    return array


def value_of(cls: type[T], **own: Read[Any]) -> Read[T]:
    """Return a reader of objects as values of a dataclass, whose fields are named as the members.

    A member may be missing where its field has a default or may be None. It is read by the type of
    the field.

    Args:
        **own: Readers of fields that need others than these.
    """
    return lambda value, where: read_rest(cls, members(value, where), {}, **own)


def read_rest(cls: type[T], found: Members, known: dict[str, Any], **own: Read[Any]) -> T:
    """Return an object as a value of a dataclass, as `value_of` does, some of which is known.

    Args:
        cls: The dataclass.
        found: The members of the object.
        known: The attributes that have been read.
        **own: As of `value_of`.
    """
    for field, name, of, shaped in _fields(cls):
        absent = _has_default(field) and found.document.get(name) is None
        if absent or field.name in known:
            continue
        by = own.get(field.name) or (_shaped(*shaped, known) if shaped else _reader(of))
        known[field.name] = (found.maybe if NoneType in get_args(of) else found.read)(name, by)
    return cls(**known)


@cache
def _fields(cls: Any) -> list[tuple[Field[Any], str, Any, tuple[Any, Shape] | None]]:
    """Return the members of a dataclass: each field, its name in answers, its type and shape."""
    types = get_type_hints(cls, include_extras=True)
    named = [(field, name_of(field), types[field.name]) for field in fields(cls)]
    return [(field, name, of, shape_of(of)) for field, name, of in named if name]


def _has_default(field: Field[Any]) -> bool:
    return field.default is not MISSING or field.default_factory is not MISSING


@cache
def _reader(of: Any) -> Read[Any]:
    """Return the reader of a type."""
    if of in _OF_TYPES:
        return _OF_TYPES[of]
    [part, *more] = [part for part in get_args(of) if part is not NoneType] or [of]
    if more and get_origin(of) in (Union, UnionType):
        return partial(_either, (_reader(part), _reader(more[0])))
    if get_origin(of) is tuple:
        return each(_reader(part), None if more == [Ellipsis] else 1 + len(more))
    return value_of(of) if part is of else _reader(part)


def _either(readers: tuple[Read[Any], Read[Any]], value: Any, where: str) -> Any:
    """Read what the first of two readers does not as the second one does."""
    try:
        return readers[0](value, where)
    except UnexpectedAnswer:
        return readers[1](value, where)


def _shaped(of: Any, shape: Shape, known: Mapping[str, Any]) -> Read[Any]:
    """Return the reader of an array or a list of a shape, given the members before."""
    sizes = shape.after(known)
    return _ARRAYS[of](*sizes) if of in _ARRAYS else each(_reader(get_args(of)[0]), *sizes)


def _object(value: Any, where: str) -> Mapping[str, Any]:
    return members(value, where).document


def _numbers(value: Any, where: str) -> dict[str, float]:
    found = members(value, where)
    return {name: found.read(name, number) for name in found.document}


_OF_TYPES: Mapping[Any, Read[Any]] = {
    str: text,
    int: count,
    float: number,
    bool: flag,
    datetime: time,
    Any: anything,
    Mapping[str, Any]: _object,
    Mapping[str, float]: _numbers,
}
_ARRAYS: Mapping[Any, Callable[..., Read[Any]]] = {
    NDArray[np.float64]: floats,
    NDArray[np.int64]: indexes,
}
