"""The fields of requests as the command and the page offer them, beside HTTP.

The annotation `Offered` of a field says where. Its name, type, bounds, default and sentence are
those of the form.
"""

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from service.requests.coverage import OF_ONE_ROBOT, CoverageRequest
from service.requests.fields import LARGEST, LARGEST_INTEGER, SMALLEST, Offered
from service.requests.fleet import FleetRequest
from service.requests.front import FrontRequest

_EXTREMES = (SMALLEST, LARGEST, LARGEST_INTEGER)  # bounds that nobody needs to read
_PLACES = ("coverage", "", "more")  # of inputs on the page


def offered(form: type[BaseModel]) -> Iterator[tuple[str, Offered, dict[str, Any]]]:
    """Yield the name of each field that is offered anywhere, where, and its JSON schema."""
    properties = form.model_json_schema()["properties"]
    for name, field in form.model_fields.items():
        for each in field.metadata:
            if isinstance(each, Offered):
                yield name, each, properties[name]


def options(form: type[BaseModel]) -> list[dict[str, Any]]:
    """Return the options of the command for the fields of a form."""
    return [
        _option(name, shown, schema)
        for name, shown, schema in offered(form)
        if shown.option is not None
    ]


def _option(name: str, shown: Offered, schema: dict[str, Any]) -> dict[str, Any]:
    sentence = schema["description"]
    found = {
        "name": name,
        "type": schema.get("type", "string"),
        "help": shown.option or f"{sentence[0].upper()}{sentence[1:]}.",
        "each": shown.each,
        "flag": shown.flag,
        "hidden": schema.get("deprecated"),
        "default": schema.get("default"),
        "min": schema.get("minimum"),
        "max": schema.get("maximum"),
    }
    return {key: value for key, value in found.items() if value not in (None, *_EXTREMES)}


def inputs() -> list[dict[str, Any]]:
    """Return the inputs of the page, in their order: those about maps first, and boxes last."""
    of_fronts = list(offered(FrontRequest))
    known = {name for name, *_ in of_fronts}
    of_maps = [each for each in offered(CoverageRequest) if each[0] not in known]
    shown = [each for each in [*of_maps, *of_fronts] if each[1].label is not None]
    shown.sort(key=lambda each: each[1].more)
    found = [_input(*each, of_map=each[0] not in known) for each in shown]
    return sorted(found, key=lambda row: (_PLACES.index(row["where"]), row["box"]))


def _input(name: str, shown: Offered, schema: dict[str, Any], of_map: bool) -> dict[str, Any]:
    box = schema.get("type") == "boolean"
    default = None if box else schema.get("default")
    value = "" if default is None else str(default)
    of_plans = name in (CoverageRequest if of_map else FleetRequest).model_fields
    return {
        "name": shown.flag or name,
        "label": shown.label,
        "where": "coverage" if of_map else "more" if shown.more else "",
        "value": value if shown.initial is None else shown.initial,
        "box": box,
        "plans": of_plans and name not in OF_ONE_ROBOT,
    }
