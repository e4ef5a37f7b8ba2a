"""OpenAPI, the client, agents, the command and the page have the fields of the forms."""

import json
import re
from collections.abc import Collection, Mapping
from typing import Any, get_args, get_type_hints

import pytest
from paretour import members
from pydantic import BaseModel
from starlette.applications import Starlette
from starlette.testclient import TestClient

from service.api.request_bodies import request_schemas
from service.api.site.static import static_routes
from service.cli import options
from service.mcp.tools import TOOLS, Tool
from service.requests.coverage import CoverageRequest
from service.requests.fields import LARGEST, LARGEST_INTEGER, SMALLEST, Offered
from service.requests.fleet import FleetRequest
from service.requests.front import FrontRequest
from service.requests.null_members import NUMBER_OR_TEXT
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from service.requests.replan.offers import OffersRequest
from tests.helpers.serving import LIMITS

Fields = dict[str, dict[str, Any]]
FORMS = (
    FrontRequest,
    FleetRequest,
    CoverageRequest,
    ReplanRequest,
    ReplanFleetRequest,
    OffersRequest,
)
FACTS = ("type", "default", "minimum", "maximum", "enum", "description")
OF_LIMITS = {"maximum", "enum"}  # of the service, and of the actors that it has loaded
TYPES = {"integer": int, "number": float, "string": str, "boolean": bool}
GROUPS: Mapping[type, type[BaseModel]] = {
    options.OfFront: FrontRequest,
    options.OfMap: CoverageRequest,
    options.OfFleet: FleetRequest,
    options.OfRest: ReplanRequest,
}


def fields(form: type[BaseModel]) -> Fields:
    """What a form says about each of its fields."""
    return {name: facts(each) for name, each in form.model_json_schema()["properties"].items()}


def facts(schema: Mapping[str, Any], without: Collection[str] = ()) -> dict[str, Any]:
    return {key: schema[key] for key in FACTS if schema.get(key) is not None and key not in without}


def offers(form: type[BaseModel]) -> dict[str, Offered]:
    """Where each field of a form is offered."""
    return {
        name: each
        for name, field in form.model_fields.items()
        for each in field.metadata
        if isinstance(each, Offered)
    }


@pytest.mark.parametrize("form", FORMS)
def test_openapi_has_them(form: type[BaseModel]) -> None:
    schemas = request_schemas(LIMITS, ["pa-one"])
    known, shown = fields(form), schemas[form.__name__]["properties"]
    assert shown.keys() == known.keys()
    for name, schema in shown.items():
        own = OF_LIMITS | ({"default"} if name in ("size", "time_limit") else set())
        assert facts(known[name], own).items() <= facts(schema, own).items()
        assert schema.get("maximum", 0) <= known[name].get("maximum", LARGEST)


@pytest.mark.parametrize("form", FORMS)
def test_the_client_has_them(form: type[BaseModel]) -> None:
    client = members.RobotsRequest if form is CoverageRequest else getattr(members, form.__name__)
    hints = get_type_hints(client)
    assert hints.keys() == fields(form).keys()
    assert fields(form)["time_limit"]["default"] == members.DEFAULT_TIME_LIMIT
    for name, fact in fields(form).items():
        if "enum" in fact:
            assert get_args(hints[name]) == tuple(fact["enum"])
        elif fact.get("type") in TYPES:
            assert hints[name] is TYPES[fact["type"]]


@pytest.mark.parametrize("tool", [each for each in TOOLS if each.forms], ids=lambda each: each.name)
def test_agents_read_them(tool: Tool) -> None:
    known: Fields = {}
    for form in tool.forms:
        known = {**fields(form), **known}
    shown = tool.schema["properties"]
    assert {"time_limit"} < shown.keys() <= known.keys()
    for name, schema in shown.items():
        own = (
            ("type",) if schema.get("type") == NUMBER_OR_TEXT else ()
        )  # they may be texts such as "10:00"
        assert facts(schema, own) == {k: v for k, v in known[name].items() if k not in own}


@pytest.mark.parametrize(("group", "form"), GROUPS.items())
def test_the_command_has_them(group: type, form: type[BaseModel]) -> None:
    made = get_type_hints(group, include_extras=True)
    known = fields(form)
    offered = {name: each for name, each in offers(form).items() if each.option is not None}
    assert made.keys() == offered.keys() - ({"actor"} if form is ReplanRequest else set())
    for name, annotation in made.items():
        optional, option = get_args(annotation)
        assert get_args(optional)[0] is TYPES.get(known[name].get("type", ""), str)
        bounds = [known[name].get(each) for each in ("minimum", "maximum")]
        extremes = (SMALLEST, LARGEST, LARGEST_INTEGER)
        assert [option.min, option.max] == [None if each in extremes else each for each in bounds]
        sentence = known[name]["description"]
        assert option.help == (offered[name].option or f"{sentence[0].upper()}{sentence[1:]}.")
        if "default" in known[name] and known[name].get("type") != "boolean":
            assert option.show_default == str(known[name]["default"])


def test_the_page_has_them() -> None:
    page = TestClient(Starlette(routes=static_routes())).get("/").text
    [text] = re.findall(r'<script id="fields-of-requests".*?>(.*?)</script>', page)
    shown = {each["name"]: each for each in json.loads(text)}
    known = {**fields(CoverageRequest), **fields(FrontRequest)}
    offered = {**offers(CoverageRequest), **offers(FrontRequest)}
    labelled = {name: each for name, each in offered.items() if each.label is not None}
    assert shown.keys() == {each.flag or name for name, each in labelled.items()}
    for name, each in labelled.items():
        made = shown[each.flag or name]
        assert made["label"] == each.label
        assert made["box"] == (known[name].get("type") == "boolean")
        initial = each.initial if each.initial is not None else known[name].get("default", "")
        assert made["box"] or made["value"] == str(initial)
