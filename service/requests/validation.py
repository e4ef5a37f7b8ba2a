"""Validate JSON against a pydantic model, and return its errors as a refusal of this service."""

from collections.abc import Iterable, Mapping, Sequence, Sized
from difflib import SequenceMatcher, get_close_matches
from heapq import nlargest
from threading import Lock
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, from_json

from service.errors import MOST_FAULTS, Fault, Refusal
from service.errors.exceptions import summary
from service.errors.faults import SENTENCES, shorten, show
from service.requests.null_members import drop_null_members, schema_of

Model = TypeVar("Model", bound=BaseModel)
_ANYTHING: Mapping[str, Any] = {}
_LONGEST_WORD = 100  # characters that are compared with other words
_MOST_COMPARED = 10
_DEEPEST = 100  # levels, half of what pydantic parses
_building = Lock()  # as pydantic does not build one model in two threads (pydantic#13419)
_NO_BRACKETS = bytes(set(range(256)).difference(b"[]{}"))


def parse_json(model: type[Model], body: bytes) -> Model:
    """Return a JSON body as a model; members that are null where null means nothing are absent.

    Raises:
        Refusal: The body is not JSON, or does not fit the model.
    """
    with _building:
        model.model_rebuild()  # unless it was built before
    try:
        return model.model_validate_json(drop_null_members(model, body))
    except ValidationError as error:
        errors = error.errors(include_url=False)
        if errors[0]["type"] == "json_invalid":
            reason = errors[0]["ctx"]["error"]
            raise Refusal("malformed-json", reason=reason) from None
        raise refusal_of(errors, schema=schema_of(model)) from None


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


def too_many_cities(part: str, limit: int, actual: int, code: str = "too-many-rows") -> Refusal:
    """Return the refusal of more cities than are allowed in a part of a request, or left by it."""
    fault = Fault.of(part, code, limit=limit, actual=actual)
    return Refusal("too-many-cities", errors=[fault], limit=limit, actual=actual)


def too_many_cells(limit: int, actual: int, came: object) -> Refusal:
    """Return the refusal of a map of more cells than are allowed; `came` is shown for `actual`."""
    return Refusal("too-many-cells", came=came, pointer="/grid", limit=limit, actual=actual)


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


def _fault(error: ErrorDetails, parameters: bool, schema: Mapping[str, Any]) -> Fault:
    # FastAPI puts "query" first; brackets mark a branch of a union, which the caller never wrote.
    parts = [str(part) for part in error["loc"] if not str(part).startswith("[")]
    code, values = _code(error, schema)
    said = "" if code in SENTENCES else _said(error)
    if parameters:
        name = shorten(".".join(parts[1:]))
        return Fault(code, name, parameter=name, values=values, said=said)
    pointer = shorten("".join("/" + part.replace("~", "~0").replace("/", "~1") for part in parts))
    return Fault(code, pointer.lstrip("/") or "the body", pointer, values=values, said=said)


def _said(error: ErrorDetails) -> str:
    """Return an error in pydantic's words, with the verb of our sentences."""
    return f"{error['msg'].replace('Input should be', 'must be', 1)}, got {show(error['input'])}"


def _code(error: ErrorDetails, schema: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return what is wrong as the code of a sentence, with its values."""
    kind, came, bounds = error["type"], error["input"], error.get("ctx", {})
    code = kind.replace("_", "-")
    match kind:
        case "missing":
            return code, {}
        case "extra_forbidden":
            *parents, unknown = error["loc"]
            fields = _schema_at(parents, schema).get("properties", ())
            return code, {"near": nearest(str(unknown), fields)}
        case "too_short" | "too_long" | "string_too_short" | "string_too_long":
            values = {**bounds, "count": len(came) if isinstance(came, Sized) else 1}
            lengths = _schema_at(error["loc"], schema)
            if "minItems" in lengths and lengths["minItems"] == lengths.get("maxItems"):
                return "exact-length", {**values, "length": lengths["minItems"]}
            return "too-few" if kind == "too_short" and bounds["min_length"] == 1 else code, values
    return code, {
        "came": came,
        **{k: v for k, v in bounds.items() if isinstance(v, int | float | str)},
    }


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
