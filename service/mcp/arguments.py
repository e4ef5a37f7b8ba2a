"""Define the arguments of the tools, whose JSON schemas an agent reads.

Those of tools that plan are members of a request. Their schemas are made of its form, without what
agents seldom need. All members are passed on, and the service checks them.
"""

from typing import Annotated, Any
from urllib.parse import parse_qs, urlsplit

from paretour.questions import OPTIONS, QUESTIONS
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field
from pydantic_core.core_schema import ModelSchema, StringSchema

from service.mcp.times import WithTimes
from service.requests.fields import SearchFields, optional
from service.requests.json_schemas import RULES

_MOST_TEXT = 2**20  # characters of a file
# The members of forms that agents seldom need. All others are in the schemas, new ones as well.
_RARE = {
    "FrontRequest": "size reference_point seed preferences repairs arrivals bound actor clock"
    " initial_tours augment geometry",
    "DayObjectiveItem": "over_the_day slices breakpoints traffic days",
    "FleetRequest": "size reference_point seed geometry",
    "FleetStopItem": "windows release",
    "VehicleItem": "shifts longest fixed max_trips initial_load breaks",
    "FleetObjectiveItem": "slices breakpoints traffic",
    "ClockItem": "matrix coordinates slices breakpoints traffic",
    "ReplanRequest": "size reference_point seed preferences repairs arrivals bound actor objectives"
    " geometry pose grid blocked freed cost_layer cost_layers paths",
    "ReplanFleetRequest": "size reference_point seed geometry add",
    "NewStop": "coordinates costs",
    "OffersRequest": "add",
    "OfferedOrder": "coordinates costs",
}


def _id_in(front: Any) -> Any:
    """Return the id in a link to a front on the page, or what came if it is none."""
    if not isinstance(front, str) or "#" not in front:
        return front
    return parse_qs(urlsplit(front).fragment).get("front", [front])[0]


Id = Annotated[str, BeforeValidator(_id_in), Field(min_length=1, max_length=100)]
Budgets = Annotated[dict[str, float | str], Field(max_length=4)]
Numbers = Annotated[dict[str, float], Field(max_length=4)]
Count = Annotated[int, Field(ge=0, le=2**31 - 1)]


class Arguments(BaseModel):
    """The arguments of a tool, or a part of them. A member that is not listed is an error."""

    model_config = ConfigDict(extra="forbid")


class ChosenColumn(Arguments):
    """A column of a table, and what it is taken for."""

    name: str = Field(description="its heading; without headings its number, from 1")
    taken_for: str = Field(
        description="id, latitude, longitude, demand, service, x, y, second x, second y, ignored or"
        " another one of the choices that an error lists"
    )
    file: str | None = optional("of several files its name, or the first")


class TextOfFile(Arguments):
    """The text of a file, and its name."""

    name: str = Field(min_length=1, max_length=100, description="such as vans.csv")
    text: str = Field(max_length=_MOST_TEXT)


class PlanFile(Arguments):
    """The text of a file, and its name; or several files."""

    text: str | None = Field(
        default=None,
        max_length=_MOST_TEXT,
        description="CSV, GeoJSON, GPX, KML, JSON, TSPLIB, CVRPLIB, Solomon, Li and Lim or VROOM",
    )
    name: str = Field(default="stops.csv", max_length=100, description="such as orders.csv")
    files: list[TextOfFile] | None = Field(
        default=None,
        max_length=10,
        description="in place of text: files that belong together, such as orders and vans",
    )
    columns: list[ChosenColumn] | None = Field(
        default=None,
        max_length=1000,
        description="what the columns of a table are taken for, if their names do not say it",
    )
    time_limit: float | None = Field(
        default=None, ge=0, description=SearchFields.model_fields["time_limit"].description
    )

    @property
    def contents(self) -> dict[str, bytes]:
        """The content of each file by its name.

        Raises:
            ValueError: There is none, or there are both a text and files.
        """
        if (self.text is None) == (not self.files):
            raise ValueError("text or files must be given, and not both")
        files = self.files or [TextOfFile(name=self.name, text=self.text or "")]
        return {each.name: each.text.encode() for each in files}


class StoredFront(Arguments):
    """A front that was planned before."""

    front: Id = Field(description="the id that a planning tool returned, or its link")


class ChooseTour(StoredFront):
    """A front and one way to choose: at_most, weights, knee, balance or number."""

    at_most: Budgets | None = optional(
        'a budget for objectives by name, such as {"time": 3600}, "2:10 h", "12 km", or "3%" for so'
        " much more than the least"
    )
    prefer: str | None = optional("with at_most: the objective that is to be least")
    weights: Numbers | None = optional("how much each objective matters")
    knee: bool | None = optional("true: the tour with the least sum of losses, a compromise")
    balance: float | None = Field(
        default=None,
        ge=0,
        le=1,
        description="of two objectives: from 0 (least of the first) to 1 (of the second)",
    )
    number: Count | None = optional("its number in the front, from 0")
    first_stop: Count = Field(
        default=0,
        description="for a long tour: how many of its stops to leave out before the first",
    )


class AskAbout(StoredFront):
    """A front, and the options that were picked so far."""

    picks: list[Count] | None = Field(
        default=None,
        max_length=10,
        description="for each question so far the number of the option that the person chose",
    )
    questions: int = Field(default=QUESTIONS, ge=1, le=10, description="how many there are")
    options: int = Field(default=OPTIONS, ge=2, le=6, description="how many each question has")


class Members(Arguments):
    """The members of a request."""

    model_config = ConfigDict(extra="allow")

    @property
    def members(self) -> dict[str, Any]:
        """The members of the request as they came."""
        return dict(self.model_extra or {})


class Changes(StoredFront, Members):
    """A front, and the changes since it was planned."""


class DayOfFleet(BaseModel):
    """What an agent says of the vehicles of a fleet in its own words."""

    done: list[int | str] | dict[str, list[str]] | str | None = optional(
        "the stops that were visited, in order. Of a fleet: for each vehicle, by its id or the"
        ' number of its route, {"van": ["a", "b"]}; or "as planned": what the plan visits until now'
    )
    broken_down: list[int | str] | None = optional(
        "of a fleet: the vehicles, or routes, that are out of service"
    )


class _ForAgents(WithTimes):
    """Make JSON schemas without what agents seldom need; forms may have other members, too."""

    def field_title_should_be_set(self, schema: Any) -> bool:  # noqa: ARG002
        return False

    def str_schema(self, schema: StringSchema) -> dict[str, Any]:
        found = super().str_schema(schema)
        return {key: value for key, value in found.items() if key != "pattern"}

    def model_schema(self, schema: ModelSchema) -> dict[str, Any]:
        found = super().model_schema(schema)
        rare = _RARE.get(schema["cls"].__name__, "").split()
        for name in rare:
            del found["properties"][name]
        left_out = {"title", *RULES, *(["additionalProperties"] if rare else [])}
        return {key: value for key, value in found.items() if key not in left_out}


def schema_of(*forms: type[BaseModel]) -> dict[str, Any]:
    """Return the JSON schema of arguments, which may be members of each of these forms."""
    first, *others = (form.model_json_schema(schema_generator=_ForAgents) for form in forms)
    for other in others:
        for key in ("properties", "$defs"):
            first[key] = {**other.get(key, {}), **first.get(key, {})}
    return first
