"""Drop the members of requests that are null where null means nothing.

Many generated clients send null for each optional member that was not set, such as those of
structs in Go and of objects in C#. So such a member counts as absent. Null keeps its meaning where
it says something else than absence, such as `start`, and among the items of a list, such as the
costs of a matrix.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from pydantic import BaseModel
from pydantic_core import from_json, to_json

_Schema = Mapping[str, Any]
_NULL_MEMBER = re.compile(rb":\s*null\b")  # also in a string, which does no harm
_NULL = {"type": "null"}
NUMBER_OR_TEXT = ["number", "string"]


@dataclass(frozen=True)
class Shape:
    """Where objects and amounts are in the values of a schema, and which null members they have.

    Args:
        dropped: The members of an object that are dropped where they are null.
        members: The shapes of the members of an object that hold objects.
        items: The shape of the items of a list; None if they hold neither.
        is_amount: Whether the value is a number that may also be a text.
    """

    dropped: frozenset[str]
    members: Mapping[str, "Shape"]
    items: "Shape | None"
    is_amount: bool = False


def drop_null_members(model: type[BaseModel], body: bytes) -> bytes:
    """Return a JSON body for a model without the members that are null and mean nothing.

    A body without such members, or that is not JSON, is returned as it is.
    """
    if not _NULL_MEMBER.search(body):
        return body
    try:
        content = from_json(body)
    except ValueError:
        return body
    return to_json(without_null_members(model, content), inf_nan_mode="constants")


def without_null_members(model: type[BaseModel], content: Any) -> Any:
    """Return parsed JSON for a model without the members that are null and mean nothing."""
    shape = _shape_of(model)
    if shape is None:
        return content
    members = _without(content, shape)
    if (
        isinstance(members, dict)
        and members.get("start", 0) is None
        and members.get("closed", True)
    ):
        del members["start"]  # only an open route can start anywhere
    return members


def _without(value: Any, shape: Shape) -> Any:
    if isinstance(value, list) and shape.items is not None:
        return [_without(each, shape.items) for each in value]
    if not isinstance(value, dict):
        return value
    return {
        name: _without(each, shape.members[name]) if name in shape.members else each
        for name, each in value.items()
        if each is not None or name not in shape.dropped
    }


@cache
def _shape_of(model: type[BaseModel]) -> Shape | None:
    schema = schema_of(model)
    return shape_of([schema], schema.get("$defs", {}))


@cache
def schema_of(model: type[BaseModel]) -> dict[str, Any]:
    """Return the JSON schema of a model."""
    return model.model_json_schema()


def shape_of(schemas: Iterable[_Schema], definitions: _Schema) -> Shape | None:
    """Return the shape of values that fit one of some JSON schemas.

    None if they hold neither objects nor numbers that may be texts.
    """
    forms = [form for schema in schemas for form in _forms(schema, definitions)]
    members: dict[str, list[_Schema]] = {}
    for form in forms:
        for name, schema in form.get("properties", {}).items():
            members.setdefault(name, []).append(schema)
    shapes = {name: shape_of(each, definitions) for name, each in members.items()}
    in_lists = [form["items"] for form in forms if "items" in form]
    items = shape_of(in_lists, definitions) if in_lists else None
    is_amount = any(form.get("type") == NUMBER_OR_TEXT for form in forms)
    if not (members or items or is_amount):
        return None
    return Shape(
        dropped=frozenset(
            name for name, each in members.items() if not any(_has_null(s) for s in each)
        ),
        members={name: shape for name, shape in shapes.items() if shape is not None},
        items=items,
        is_amount=is_amount,
    )


def _forms(schema: _Schema, definitions: _Schema) -> list[_Schema]:
    """Return the schemas of the forms that a value may have, without references."""
    if "$ref" in schema:
        schema = definitions[schema["$ref"].removeprefix("#/$defs/")]
    either = [*schema.get("anyOf", ()), *schema.get("oneOf", ())]
    return [form for each in either for form in _forms(each, definitions)] if either else [schema]


def _has_null(member: _Schema) -> bool:
    """Return whether null is a value of a member, and not the one that it has if it is absent."""
    return _NULL in member.get("anyOf", ()) and member.get("default", ...) is not None
