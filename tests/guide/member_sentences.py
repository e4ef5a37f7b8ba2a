"""What the members of requests are, from the fields of the service, for the help of the client."""

import json
import textwrap
from collections.abc import Iterator, Mapping
from typing import Any, get_type_hints

from paretour import members
from pydantic import BaseModel

from service.requests.coverage import CoverageRequest
from service.requests.fleet import FleetRequest
from service.requests.front import FrontRequest
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.fleet_fields import ReplanFleetRequest
from tests.guide.pages import ROOT

FILE = ROOT / "service/client/paretour/members.json"
REQUESTS: Mapping[type, type[BaseModel]] = {
    members.FrontRequest: FrontRequest,
    members.FleetRequest: FleetRequest,
    members.CoverageRequest: CoverageRequest,
    members.RobotsRequest: CoverageRequest,
    members.ReplanRequest: ReplanRequest,
    members.ReplanFleetRequest: ReplanFleetRequest,
}
_WRAPPER = textwrap.TextWrapper(width=84, subsequent_indent="    ", break_on_hyphens=False)


def sentences(request: type) -> dict[str, str]:
    """Return the sentence of each member of a request, and as `stops.id` of those inside it."""
    schema = REQUESTS[request].model_json_schema()
    return dict(_described(schema, schema["$defs"], get_type_hints(request)))


def member_lines() -> str:
    """Return the lines of the help on each request as JSON, by the name of its type."""
    lines = {
        request.__name__: [
            line
            for name, sentence in sentences(request).items()
            for line in _WRAPPER.wrap(f"{name}: {sentence}")
        ]
        for request in REQUESTS
    }
    return json.dumps(lines, indent=1, ensure_ascii=False) + "\n"


def _described(
    schema: Any, parts: Mapping[str, Any], names: Mapping[str, Any] | None = None, of: str = ""
) -> Iterator[tuple[str, str]]:
    """Yield the members of a schema, or those with these names, and what they consist of."""
    for name, member in schema.get("properties", {}).items():
        if (names is not None and name not in names) or "description" not in member:
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
