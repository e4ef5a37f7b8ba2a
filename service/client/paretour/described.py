"""Declare the objects of answers, each once: its members, their types, and a sentence on each.

The client reads an object by its declaration (`expect.value_of`). The help on the object, and its
schema in the service's OpenAPI document, are made of the same declaration.
"""

import textwrap
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields
from math import isnan, nan
from typing import Annotated, Any, TypeVar, dataclass_transform, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T")
Array = NDArray[np.float64]
SCHEMAS: dict[type, str] = {}  # the name of each object in the OpenAPI document
_WRAPPER = textwrap.TextWrapper(
    width=92, initial_indent=" " * 4, subsequent_indent=" " * 8, break_on_hyphens=False
)


class Shape:
    """The shape of an array, or the length of a list, as an annotation of its type.

    Args:
        *sizes: Of each dimension the size: a number; the name of an earlier member of the same
            object, which has as many items; or None for any.
        more: How many more items there are than that member has.
    """

    def __init__(self, *sizes: int | str | None, more: int = 0) -> None:
        self.sizes = sizes
        self.more = more

    def after(self, known: Mapping[str, Any]) -> list[int | None]:
        """Return the size of each dimension, given the members before; None for any."""
        lengths = {name: len(known[name]) + self.more for name in self.sizes if name in known}
        return [lengths.get(size) if isinstance(size, str) else size for size in self.sizes]

    def __repr__(self) -> str:
        more = f" + {self.more}" if self.more else ""
        named = {None: "k", "lengths": "m"}
        sizes = [
            str(size) if isinstance(size, int) else named.get(size, f"len({size}){more}")
            for size in self.sizes
        ]
        return f"shape ({', '.join(sizes)}{',' * (len(sizes) == 1)})"


Lengths = Annotated[Array, Shape("lengths")]  # one for each objective
Indexes = Annotated[NDArray[np.int64], Shape(None)]
# Sentences on where tours and plans stand.
OF_TWO = "of two objectives: 0 at the front's least first length, 1 at its least second"
OF_MORE = (
    "of more objectives: each length in the front's own box, 0 at its least and 1 at its greatest"
)


def shape_of(of: Any) -> tuple[Any, Shape] | None:
    """Return the type of a member without its shape, and that; None if it has none."""
    for part in (of, *get_args(of)):
        for each in getattr(part, "__metadata__", ()):
            if isinstance(each, Shape):
                return part.__origin__, each
    return None


def member(
    sentence: str = "", *, default: Any = MISSING, always: bool = False, named: str | None = None
) -> Any:
    """Declare a member.

    It is optional where it has a default, or may be None.

    Args:
        sentence: What it is, if its name does not say that.
        default: Its value where it is missing.
        always: Whether the service always sends it all the same, if only as null. The default is
            for earlier services.
        named: Its name in answers, if that is another than the attribute's; "" if it has none.
    """
    metadata = {"sentence": sentence, "always": always, "named": named}
    if default == {}:
        return field(default_factory=dict, metadata=metadata)
    return field(default=default, metadata=metadata)


def of_each(name: str, item: Any = None) -> Any:
    """Declare an attribute that has a member of each item of a front.

    Args:
        name: The name of the member.
        item: The class of the items, which says what the member is.
    """
    declared = () if item is None else fields(item)
    said = [f"of each, {it.metadata['sentence']}" for it in declared if it.name == name]
    return field(default=None, metadata={"sentence": "".join(said), "named": "", "of_each": name})


def name_of(declared: Field[Any]) -> str:
    """Return the name of a member in answers; "" if it is in none."""
    named: str | None = declared.metadata.get("named")
    return declared.name if named is None else named


@dataclass_transform(
    kw_only_default=True, frozen_default=True, eq_default=False, field_specifiers=(member, of_each)
)
def answer(schema: str, *, eq: bool = False, kw_only: bool = True) -> Callable[[type[T]], type[T]]:
    """Return a decorator of a class whose values are objects of an answer: frozen dataclasses.

    Args:
        schema: The name of the object in the OpenAPI document.
        eq: Whether values are compared by their members, which must have no arrays.
        kw_only: Whether members are given by name alone.
    """

    def decorate(cls: type[T]) -> type[T]:
        plain = (each for each in cls.__mro__[:-1] if each not in SCHEMAS)
        has_own = any("__repr__" in vars(each) for each in plain)  # or one that it inherits
        made = dataclass(frozen=True, eq=eq, kw_only=kw_only, repr=not has_own)(cls)
        made.__doc__ = "\n".join((f"{made.__doc__}\n\nAttributes:", *_help(made)))
        SCHEMAS[made] = schema
        return made

    return decorate


def document_of(value: Any) -> Any:
    """Return an object as it is in an answer, ready for JSON, without the members that it lacks."""
    if type(value) in SCHEMAS:
        members = {each.name: getattr(value, each.name) for each in fields(value)}
        lacking = {each.name for each in fields(value) if _lacks(each, members[each.name])}
        return {name: document_of(each) for name, each in members.items() if name not in lacking}
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [document_of(each) for each in value] if isinstance(value, tuple) else value


def _lacks(field: Field[Any], value: Any) -> bool:
    """Return whether a value of an optional member stands for none."""
    if field.metadata.get("always"):
        return False
    is_default = isinstance(value, type(field.default)) and value == field.default
    return value is None or is_default or (isinstance(value, float) and isnan(value))


def sentence_on(cls: type) -> str:
    """Return what an object is: the first sentence of its help."""
    return (cls.__doc__ or "").partition("\n\n")[0]


def _help(cls: Any) -> Iterator[str]:
    """Yield the lines of the help on each member of an object."""
    hints = get_type_hints(cls, include_extras=True)
    for each in fields(cls):
        sentence = each.metadata.get("sentence", "")
        shaped = shape_of(hints[each.name])
        said = [sentence[:1].upper() + sentence[1:]] if sentence else []
        said += [repr(shaped[1])] if shaped else []
        said += ["else NaN"] if each.default is nan else []
        yield from _WRAPPER.wrap(f"{each.name}: {', '.join(said)}." if said else each.name)
