"""The members of requests for the client, the command and the page, made of the service's forms."""

import json
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from service.front import BOUND_SECONDS
from service.requests.coverage import CoverageRequest
from service.requests.fields import PlanFields, SearchFields
from service.requests.fleet import FleetRequest
from service.requests.front import FrontRequest
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from service.requests.replan.offers import OffersRequest
from service.requests.tour import TourQuery
from tests.guide.offered import inputs, options
from tests.guide.pages import ROOT

JSON = ROOT / "service/client/paretour/members.json"
TYPES = ROOT / "service/client/paretour/members.py"
PARTS = ROOT / "service/client/paretour/member_parts.py"
FORMS: Mapping[str, type[BaseModel]] = {
    "FrontRequest": FrontRequest,
    "FleetRequest": FleetRequest,
    "CoverageRequest": CoverageRequest,
    "RobotsRequest": CoverageRequest,
    "ReplanRequest": ReplanRequest,
    "ReplanFleetRequest": ReplanFleetRequest,
    "OffersRequest": OffersRequest,
}
_OF_ROBOTS = ("robots", "over")
_SHARED = {"SearchOptions": SearchFields, "PlanOptions": PlanFields}
# The types that have the members of another one, too.
_BASES = {
    "PlanOptions": "SearchOptions",
    "FrontRequest": "PlanOptions",
    "FleetRequest": "SearchOptions",
    "CoverageRequest": "PlanOptions",
    "RobotsRequest": "CoverageRequest",
    "ReplanRequest": "PlanOptions",
    "ReplanFleetRequest": "SearchOptions",
}
_CHANGES = "FleetChanges"
# Bases of the members that several types have, and what they are, unless they are types as well.
_COMMON: Mapping[str, tuple[tuple[str, ...], str]] = {
    "FleetStopRequest": (("NewFleetStopRequest",), ""),
    "CostsRequest": (
        ("ObjectiveRequest", "FleetObjectiveRequest", "ClockRequest"),
        "The source of costs.",
    ),
    "OrderRequest": (
        ("FleetStopRequest", "OfferedOrderRequest"),
        "A stop, and its demands on the vehicle that visits it, whenever that is.",
    ),
    "ReachedRequest": (
        ("NewStopRequest", "NewFleetStopRequest", "OfferedOrderRequest"),
        "How to reach a new stop under each objective.",
    ),
    _CHANGES: (
        ("ReplanFleetRequest", "OffersRequest"),
        "The changes since a fleet was planned.",
    ),
}
_PLAIN = {
    "integer": "int",
    "number": "float",
    "string": "str",
    "boolean": "bool",
    "null": "None",
}
_SHORT = 3  # names in a Literal, which fit into a line
_NUMBERS = {"int", "float", "ArrayLike", "Costs"}  # which an array of any library may hold
_ROWS = "Sequence[Sequence[float | None] | ArrayLike] | ArrayLike"
_HEAD_OF_PARTS = '''\
"""The parts of requests, such as stops, as types of dictionaries: made of the service's forms.

`python -m tests.guide` writes this module. Types are calls where a member is called `from`.
"""

from collections.abc import Sequence
from typing import Literal, Required, TypedDict

from numpy.typing import ArrayLike
from paretour.frames import Costs
'''
_HEAD = f'''\
"""The members of requests, as types of dictionaries: made of the service's forms.

`python -m tests.guide` writes this module.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Literal, Required, TypedDict

from numpy.typing import ArrayLike
from paretour.frames import Costs, Frame
from paretour.member_parts import (
PARTS_USED
)

DEFAULT_TIME_LIMIT = {FrontRequest.model_fields["time_limit"].default}  # seconds
BOUND_SECONDS = {BOUND_SECONDS}  # the most that the service takes to prove a bound
'''
_WRAPPER = textwrap.TextWrapper(width=84, subsequent_indent="    ", break_on_hyphens=False)


def sentences(request: str) -> dict[str, str]:
    """Return the sentence of each member of a request, and as `stops.id` of those inside it."""
    schema = _form(request)
    return dict(_described(schema, schema["$defs"]))


def json_file() -> str:
    """Return the help on each request, the command's options and the page's inputs as JSON."""
    lines = {
        request: [
            line
            for name, sentence in sentences(request).items()
            for line in _WRAPPER.wrap(f"{name}: {sentence}")
        ]
        for request in FORMS
    }
    of_command = {name: options(form) for name, form in {**FORMS, "TourQuery": TourQuery}.items()}
    made = {"help": lines, "options": of_command, "inputs": inputs()}
    return json.dumps(made, indent=1, ensure_ascii=False) + "\n"


def type_files() -> dict[Path, str]:
    """Return the modules with the type of each request, and of all that is in requests."""
    made: dict[str, _Type | str] = {}
    for request in ("SearchOptions", *_BASES, "OffersRequest"):
        schema = _form(request)
        _add(made, request, schema, schema.get("$defs", {}))
    for base, (users, sentence) in _COMMON.items():
        made = _with_base(made, base, users, sentence)
    types = {name: _text(name, each) for name, each in made.items()}
    whole = {name: each for name, each in types.items() if name in {*_SHARED, *FORMS, _CHANGES}}
    requests = "\n\n".join(whole.values())
    parts = {name: each for name, each in types.items() if name not in whole}
    used = [name for name in sorted(parts) if re.search(rf"\b{name}\b", requests)]
    head = _HEAD.replace("PARTS_USED", "\n".join(f"    {name}," for name in used))
    return {
        TYPES: "\n\n".join((head, requests)),
        PARTS: "\n\n".join((_HEAD_OF_PARTS, *parts.values())),
    }


@dataclass(frozen=True)
class _Type:
    """A type of dictionaries, with those of its members that its bases lack."""

    sentence: str
    members: Mapping[str, str]
    bases: tuple[str, ...] = ()


def _with_base(
    types: Mapping[str, _Type | str], base: str, users: tuple[str, ...], sentence: str
) -> dict[str, _Type | str]:
    """Return types of which some have a base, for the members that all of these have alike."""
    first, *others = (_members_of(types[name]).items() for name in (base, *users) if name in types)
    shared = dict(each for each in first if all(each in other for other in others))
    found: dict[str, _Type | str] = {}
    for name, each in types.items():
        if name in users and base not in {*types, *found}:
            found[base] = _Type(sentence, shared)
        if name in users and isinstance(each, _Type):
            rest = {member: of for member, of in each.members.items() if member not in shared}
            each = _Type(each.sentence, rest, (base, *each.bases))
        found[name] = each
    return found


def _members_of(of: _Type | str) -> Mapping[str, str]:
    return {} if isinstance(of, str) else of.members


def _form(request: str) -> dict[str, Any]:
    """Return the JSON schema of a request; the one for a single robot has no others."""
    schema = {**FORMS, **_SHARED}[request].model_json_schema()
    if request == "CoverageRequest":
        for name in _OF_ROBOTS:
            del schema["properties"][name]
    elif request == "RobotsRequest":
        schema |= {"required": ["robots"], "description": "Places that several robots share."}
    return schema


def _add(types: dict[str, _Type | str], name: str, form: Any, parts: Mapping[str, Any]) -> None:
    """Add the type of a form, after the types that it consists of."""
    for part in _parts(form["properties"]):
        if _type_name(part, parts) not in types and _is_closed(parts[part]):
            _add(types, _type_name(part, parts), parts[part], parts)
    bases = (_BASES[name],) if name in _BASES else ()
    known = {member for base in bases for member in _form(base)["properties"]}
    members = {}
    for member, schema in form["properties"].items():
        if member in known:
            continue
        choices = _choices(schema, parts)
        if len(schema.get("enum", _enumerated(schema))) > _SHORT:
            values = schema.get("enum", _enumerated(schema))
            lines = [f"    {json.dumps(each)}," for each in values]
            types[member] = "\n".join([f"{member.title()} = Literal[", *lines, "]\n"])
            choices[0] = member.title()
        of_request = member == "stops" and name in FORMS
        of = " | ".join([*choices, *(["Frame"] if of_request else [])])
        members[member] = f"Required[{of}]" if member in form.get("required", ()) else of
    types[name] = _Type(form["description"].partition("\n")[0], members, bases)


def _text(name: str, of: _Type | str) -> str:
    """Return the text of a type in its module."""
    if isinstance(of, str):
        return of
    if "from" not in of.members:
        bases = ", ".join(of.bases) or "TypedDict"
        lines = [f"class {name}({bases}, total=False):", f'    """{of.sentence}"""']
        lines += ["", *(f"    {member}: {each}" for member, each in of.members.items())]
        lines = lines if of.members else lines[:2]
    else:
        lines = [f"# {of.sentence}", f"{name} = TypedDict(", f'    "{name}",', "    {"]
        lines += [f'        "{member}": {each},' for member, each in of.members.items()]
        lines += ["    },", "    total=False,", ")"]
    return "\n".join(lines) + "\n"


def _type_name(form: str, parts: Mapping[str, Any]) -> str:
    """Return the name of the client's type for a part of a form."""
    if not _is_closed(parts[form]):
        return "Mapping[str, Any]"
    return f"{form.removesuffix('Item').removeprefix('Day').removesuffix('Request')}Request"


def _is_closed(form: Any) -> bool:
    """Return whether a form has no other members than those that are listed."""
    return form.get("additionalProperties") is False


def _enumerated(schema: Any) -> list[str]:
    return [name for each in schema.get("anyOf", ()) for name in each.get("enum", ())]


def _choices(schema: Any, parts: Mapping[str, Any]) -> list[str]:
    """Return the types of which a member of this schema has one."""
    for key in ("anyOf", "oneOf"):
        if key in schema:
            found = [of for each in schema[key] for of in _choices(each, parts)]
            return list(dict.fromkeys(found))
    if "$ref" in schema:
        return [_type_name(schema["$ref"].rpartition("/")[2], parts)]
    if "enum" in schema:
        return [f"Literal[{', '.join(map(json.dumps, schema['enum']))}]"]
    if schema["type"] == "array":
        return _array(_choices(schema.get("items") or {"anyOf": schema["prefixItems"]}, parts))
    return [_PLAIN[schema["type"]]]


def _array(each: Sequence[str]) -> list[str]:
    """Return the types of an array of these. Those of numbers may be of any library."""
    if set(each) <= _NUMBERS - {"Costs"}:
        return ["ArrayLike"]
    found = [f"Sequence[{' | '.join(each)}]", *(["ArrayLike"] if _NUMBERS & set(each) else [])]
    return ["Costs"] if " | ".join(found) == _ROWS else found


def _described(schema: Any, parts: Mapping[str, Any], of: str = "") -> Iterator[tuple[str, str]]:
    """Yield the members of a schema with their sentences, and what they consist of."""
    for name, member in schema.get("properties", {}).items():
        if "description" not in member:
            continue
        yield f"{of}{name}", member["description"]
        for part in _parts(member):
            yield from _described(parts[part], parts, of=f"{of}{name}.")


def _parts(schema: Any) -> Iterator[str]:
    """Yield the names of the schemas to which a schema refers."""
    if isinstance(schema, list):
        for each in schema:
            yield from _parts(each)
    elif isinstance(schema, Mapping):
        if "$ref" in schema:
            yield schema["$ref"].rpartition("/")[2]
        yield from _parts(list(schema.values()))
