"""Members that are null are answered as if they were absent, but for those where null says more."""

import json
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import pytest
from pydantic import BaseModel

from service.errors import Refusal
from service.mcp.arguments import ChooseTour, PlanFile, StoredFront
from service.requests.coverage import CoverageRequest, parse_coverage_request
from service.requests.fleet import FleetRequest
from service.requests.front import FrontRequest
from service.requests.null_members import drop_null_members, without_null_members
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from service.requests.replan.offers import OffersRequest
from service.requests.validation import parse_json
from tests.helpers.serving import LIMITS

Schema = Mapping[str, Any]
FORMS = (
    FrontRequest,
    FleetRequest,
    CoverageRequest,
    ReplanRequest,
    ReplanFleetRequest,
    OffersRequest,
)
KEPT = {"costs/cost"}  # no way there, instead of an entry without a cost


def members(
    schema: Schema, form: Schema, body: Callable[[Any], Any] = lambda whole: whole, path: str = ""
) -> Iterator[tuple[str, Any, Any]]:
    """Yield each member of a form, also of the parts of it, as a body without it and with null."""
    whole = sample(schema, form)
    for name, member in form.get("properties", {}).items():
        absent = {other: value for other, value in whole.items() if other != name}
        yield path + name, body(absent), body({**absent, name: None})
        for inner in forms(schema, member):
            of_member = partial(_with, body, absent, name)
            of_item = partial(_with_item, body, absent, name)
            yield from members(schema, inner, of_member, f"{path}{name}/")
            for item in forms(schema, inner.get("items", {})):
                yield from members(schema, item, of_item, f"{path}{name}/")


def _with(body: Callable[[Any], Any], whole: Any, name: str, part: Any) -> Any:
    return body({**whole, name: part})


def _with_item(body: Callable[[Any], Any], whole: Any, name: str, item: Any) -> Any:
    return body({**whole, name: [item]})


def forms(schema: Schema, member: Schema) -> list[Schema]:
    """Return the schemas that a member may fit, references followed."""
    if "$ref" in member:
        member = schema["$defs"][member["$ref"].rsplit("/", 1)[-1]]
    either = [*member.get("anyOf", ()), *member.get("oneOf", ())]
    return [form for each in either for form in forms(schema, each)] if either else [member]


def sample(schema: Schema, member: Schema) -> Any:
    """Return a small value of a schema, with the members that it requires."""
    form = forms(schema, member)[0]
    if "const" in form or "enum" in form:
        return form.get("const", form.get("enum", [None])[0])
    match form.get("type"):
        case "object":
            required = form.get("required", ())
            return {name: sample(schema, form["properties"][name]) for name in required}
        case "array" if "prefixItems" in form:
            return [sample(schema, each) for each in form["prefixItems"]]
        case "array":
            return [sample(schema, form["items"])] * max(1, form.get("minItems", 0))
        case "string":
            return "a"
        case "boolean":
            return True
    return form.get("minimum", 1)


def outcome(model: type[BaseModel], body: Any) -> Any:
    """Return how a body is read: the members that were given, or the refusal."""
    try:
        return repr(parse_json(model, json.dumps(body).encode()).model_dump(exclude_unset=True))
    except Refusal as refusal:
        return refusal.detail, refusal.errors


@pytest.mark.parametrize("model", FORMS)
def test_a_member_that_is_null_is_read_as_if_it_were_absent(model: type[BaseModel]) -> None:
    schema = model.model_json_schema()
    table = [*members(schema, schema)]
    different = {
        path for path, absent, null in table if outcome(model, absent) != outcome(model, null)
    }
    assert different == KEPT & {path for path, _, _ in table}
    assert len(table) > 30


@pytest.mark.parametrize("model", [PlanFile, StoredFront, ChooseTour])
def test_an_argument_of_a_tool_that_is_null_is_absent(model: type[BaseModel]) -> None:
    arguments = {"text": "a,b", "front": "f"}
    given = {name: arguments.get(name) for name in model.model_fields}
    kept = {name: value for name, value in given.items() if value is not None}
    assert without_null_members(model, given) == kept


@pytest.mark.parametrize(
    "body",
    [
        b'{"size": 5, "matrices": [[[0, null], [1, 0]], [[0, 1], [1, 0]]]}',
        b'{"unknown": null, "stops": [null, {"unknown": null}], "start": null, "closed": false}',
        b'{"actor": ": null", "x": "\\": null"}',
        b'{"seed": null',
        b"[" * 50_000 + b": null",
    ],
)
def test_null_stays_where_it_is_no_member_of_the_form(body: bytes) -> None:
    assert drop_null_members(FrontRequest, body).replace(b" ", b"") == body.replace(b" ", b"")


def test_what_stays_is_as_it_was() -> None:
    body = b'{"coordinates":[[1e-7,NaN,-0.0,12345678901234567890123456789]],"actor":"\xc3\xa9"}'
    given = body.replace(b'"actor"', b'"seed": null, "actor"')
    assert drop_null_members(FrontRequest, given) == body


def test_null_means_nothing_where_a_map_has_robots_or_a_pose() -> None:
    grid = {"grid": [[0, 0]], "cell_size": 1, "second_coordinates": None, "places": None}
    for more in (
        {"robots": [{"id": "a", "start": None}], "spacing": 1, "origin": [0, 0, 0]},
        {"start_pose": [0.5, 0.5], "end_pose": None, "spacing": 1, "origin": [0, 0, 0]},
    ):
        for closed in (True, False):
            body = {**grid, **more, "start": None, "closed": closed}
            parse_coverage_request(json.dumps(body).encode(), LIMITS)
