"""Define the arguments of the tools, whose JSON schemas an agent reads.

Those of tools that plan are members of a request. Their schemas are made of its form, without what
agents seldom need. All members are passed on, and the service checks them.
"""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field
from pydantic_core.core_schema import ModelSchema, StringSchema

from service.requests.fields import SearchFields
from service.requests.json_schemas import RULES, WithoutNull

_MOST_TEXT = 2**20  # characters of a file
# The members of forms that agents seldom need. All others are in the schemas, new ones as well.
_RARE = {
    "FrontRequest": "size reference_point seed preferences repairs arrivals bound actor clock"
    " initial_tours augment geometry",
    "DayObjectiveItem": "over_the_day slices traffic",
    "FleetRequest": "size reference_point seed geometry",
    "FleetStopItem": "windows due release skills vehicle",
    "VehicleItem": "shift shifts max_overtime longest fixed skills max_stops reload max_trips"
    " initial_load breaks",
    "ClockItem": "matrix coordinates",
    "ReplanRequest": "size reference_point seed preferences repairs arrivals bound actor objectives"
    " geometry pose grid blocked freed cost_layer cost_layers paths",
    "ReplanFleetRequest": "size reference_point seed geometry add",
    "NewStop": "coordinates costs",
}
Id = Annotated[str, Field(min_length=1, max_length=100)]
Numbers = Annotated[dict[str, float], Field(max_length=4)]
Count = Annotated[int, Field(ge=0, le=2**31 - 1)]


class Arguments(BaseModel):
    """The arguments of a tool. An argument that is not listed is an error."""

    model_config = ConfigDict(extra="forbid")


class ChosenColumn(BaseModel):
    """A column of a table, and what it is taken for."""

    model_config = ConfigDict(extra="forbid")

    name: str = Field(description="its heading; without headings its number, from 1")
    taken_for: str = Field(
        description="id, latitude, longitude, demand, service, x, y, second x, second y, ignored or"
        " another one of the choices that an error lists"
    )


class PlanFile(Arguments):
    """The text of a file, and its name."""

    text: str = Field(
        max_length=_MOST_TEXT,
        description="CSV, GeoJSON, GPX, KML, JSON, TSPLIB, CVRPLIB, Solomon, Li and Lim or VROOM",
    )
    name: str = Field(default="stops.csv", max_length=100, description="such as orders.csv")
    columns: list[ChosenColumn] | None = Field(
        default=None,
        max_length=1000,
        description="what the columns of a table are taken for, if their names do not say it",
    )
    time_limit: float | None = Field(
        default=None, ge=0, description=SearchFields.model_fields["time_limit"].description
    )


class StoredFront(Arguments):
    """A front that was planned before."""

    front: Id = Field(description="the id that a planning tool returned")


class ChooseTour(StoredFront):
    """A front and one way to choose: at_most, weights, knee, balance or number."""

    at_most: Numbers | None = Field(
        default=None, description='a budget for objectives by name, such as {"time": 3600}'
    )
    prefer: str | None = Field(
        default=None, description="with at_most: the objective that is to be least"
    )
    weights: Numbers | None = Field(default=None, description="how much each objective matters")
    knee: bool | None = Field(default=None, description="true: the tour with the best balance")
    balance: float | None = Field(
        default=None,
        ge=0,
        le=1,
        description="of two objectives: from 0 (least of the first) to 1 (of the second)",
    )
    number: Count | None = Field(default=None, description="its number in the front, from 0")
    first_stop: Count = Field(
        default=0,
        description="for a long tour: how many of its stops to leave out before the first",
    )


class Members(Arguments):
    """The members of a request."""

    model_config = ConfigDict(extra="allow")

    @property
    def members(self) -> dict[str, Any]:
        """The members of the request as they came."""
        return dict(self.model_extra or {})


class Changes(StoredFront, Members):
    """A front, and the changes since it was planned."""


class _ForAgents(WithoutNull):
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
