"""Validate JSON against a pydantic model, and word each error as a refusal of this service."""

import re
from collections.abc import Iterable, Mapping, Sequence, Sized
from difflib import SequenceMatcher, get_close_matches
from functools import cache
from heapq import nlargest
from threading import Lock
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, from_json, to_json

from service.errors import MOST_FAULTS, Fault, Refusal
from service.errors.exceptions import summary

Model = TypeVar("Model", bound=BaseModel)
_ANYTHING: Mapping[str, Any] = {}
_LONGEST_WORD = 100  # characters that are compared with other words
_MOST_COMPARED = 10
_DEEPEST = 100  # levels, half of what pydantic parses
# What pydantic says less well than these: its name of an error, and the end of our sentence.
_DEMANDS = {
    "missing": "is required",
    "extra_forbidden": "is not a field that this request has",
    "exact_length": "must have {length} items, got {count}",
    "too_short": "must have {min_length} {items} or more, got {count}",
    "too_long": "must have {max_length} items or fewer, got {count}",
    "string_too_short": "must have {min_length} character or more, got {count}",
    "string_too_long": "must have {max_length} characters or fewer, got {count}",
    "string_pattern_mismatch": "must be printable, in one line, got {value}",
    "greater_than_equal": "must be at least {ge:.16g}, got {value}",
    "less_than_equal": "must be at most {le:.16g}, got {value}",
}
_building = Lock()  # as pydantic does not build one model in two threads (pydantic#13419)
_NO_BRACKETS = bytes(set(range(256)).difference(b"[]{}"))


def parse_json(model: type[Model], body: bytes) -> Model:
    """Return a JSON body as a model.

    Raises:
        Refusal: The body is not JSON, or does not fit the model.
    """
    with _building:
        model.model_rebuild()  # unless it was built before
    try:
        return model.model_validate_json(body)
    except ValidationError as error:
        errors = error.errors(include_url=False)
        if errors[0]["type"] == "json_invalid":
            reason = errors[0]["ctx"]["error"]
            raise Refusal("malformed-json", reason=reason) from None
        raise refusal_of(errors, schema=_schema_of(model)) from None


def check_depth(body: bytes) -> None:
    """Raise a refusal where a body is JSON that is nested more deeply than parse_json takes.

    Brackets in strings are counted too, as that takes a tenth of the time: they may hide the
    depth from this check, and then parse_json refuses the body.

    Raises:
        Refusal: It is nested too deeply, or not JSON before that depth.
    """
    brackets = np.frombuffer(body.translate(None, _NO_BRACKETS), np.uint8)
    opening = (brackets == ord("[")) | (brackets == ord("{"))
    depths = np.cumsum(np.where(opening, 1, -1))
    if depths.max(initial=0) <= _DEEPEST:
        return
    try:
        from_json(body)
    except ValueError as error:
        raise Refusal("malformed-json", reason=str(error)) from None


def refusal_of(
    errors: Sequence[ErrorDetails],
    parameters: bool = False,
    schema: Mapping[str, Any] = _ANYTHING,
) -> Refusal:
    """Return pydantic's errors in a body of this JSON schema, or in query parameters."""
    faults = [_fault(error, parameters, schema) for error in errors[:MOST_FAULTS]]
    return Refusal("invalid-request", errors=faults, detail=summary(faults[0], len(errors)))


def too_many_cities(part: str, limit: int, actual: int, condition: str = "") -> Refusal:
    """Return the refusal of more rows, each a city, than are allowed, under a condition if any."""
    detail = f"{part} must have at most {limit} rows{condition}, got {actual}"
    return too_many_stops(part, detail, limit, actual)


def too_many_stops(part: str, detail: str, limit: int, actual: int) -> Refusal:
    """Return the refusal of more cities than are allowed, in these words."""
    return Refusal("too-many-cities", detail=detail, pointer=f"/{part}", limit=limit, actual=actual)


def too_many_cells(limit: int, actual: int, came: object) -> Refusal:
    """Return the refusal of a map of more cells than are allowed; `came` is shown for `actual`."""
    return Refusal("too-many-cells", came=came, pointer="/grid", limit=limit, actual=actual)


def shorten(text: str) -> str:
    """Return at most 80 characters of what came, to be shown in a sentence."""
    return text if len(text) <= 80 else f"{text[:79]}…"


def show(value: object) -> str:
    """Return what came as a short text, to be shown in a sentence."""
    match value:
        case list():
            return f"a list of {len(value)}"
        case dict():
            return "an object"
        case int() if abs(value) >= 10**40:
            return "an integer of more than 40 digits"
        case _:
            return shorten(to_json(value, inf_nan_mode="constants").decode())


def nearest(word: str, words: Iterable[str]) -> str | None:
    """Return the word that is most like another one, in any case; None if no word is like it.

    To compare two words takes difflib up to the cube of their length. So it compares only the few
    words that have the most letters in common with this one, which are found in linear time.
    """
    folded = {each.casefold(): each for each in words}
    word = word[:_LONGEST_WORD].casefold()
    matcher = SequenceMatcher(b=word)

    def share(other: str) -> float:
        matcher.set_seq1(other)
        return matcher.quick_ratio()

    alike = nlargest(_MOST_COMPARED, folded, key=share)
    near = get_close_matches(word, alike, n=1)
    return folded[near[0]] if near else None


@cache
def _schema_of(model: type[BaseModel]) -> dict[str, Any]:
    return model.model_json_schema()


def _fault(error: ErrorDetails, parameters: bool, schema: Mapping[str, Any]) -> Fault:
    # FastAPI puts "query" first; brackets mark a branch of a union, which the caller never wrote.
    parts = [str(part) for part in error["loc"] if not str(part).startswith("[")]
    if parameters:
        name = shorten(".".join(parts[1:]))
        return Fault(detail=f"{name} {_demand(error, schema)}", parameter=name)
    pointer = shorten("".join("/" + part.replace("~", "~0").replace("/", "~1") for part in parts))
    name = pointer.lstrip("/") or "the body"
    sentence = f"{name} {_demand(error, schema)}{_hint(error, schema)}"
    return Fault(detail=sentence, pointer=pointer)


def _hint(error: ErrorDetails, schema: Mapping[str, Any]) -> str:
    """Return the field that the caller may have meant, as the end of a sentence."""
    if error["type"] != "extra_forbidden":
        return ""
    *parents, unknown = error["loc"]
    fields = _schema_at(parents, schema).get("properties", ())
    near = nearest(str(unknown), fields)
    return f"; did you mean {near}?" if near else ""


def _schema_at(loc: Iterable[int | str], schema: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the part of a JSON schema that is about a place in a body; empty where none is."""
    at = schema
    for part in loc:
        at = (
            at.get("items", {}) if isinstance(part, int) else at.get("properties", {}).get(part, {})
        )
        if "$ref" in at:
            at = schema["$defs"][at["$ref"].removeprefix("#/$defs/")]
    return at


def _demand(error: ErrorDetails, schema: Mapping[str, Any]) -> str:
    """Return what the part at fault must be, and what came, as the end of a sentence."""
    kind, came, bounds = error["type"], error["input"], error.get("ctx", {})
    if kind in ("too_short", "too_long"):
        lengths = _schema_at(error["loc"], schema)
        if "minItems" in lengths and lengths["minItems"] == lengths.get("maxItems"):
            kind, bounds = "exact_length", {"length": lengths["minItems"]}
    if kind not in _DEMANDS:
        return f"{re.sub(r'^Input should be', 'must be', error['msg'])}, got {show(came)}"
    items = "item" if bounds.get("min_length") == 1 else "items"
    count = len(came) if isinstance(came, Sized) else 1
    return _DEMANDS[kind].format(**bounds, items=items, count=count, value=show(came))
