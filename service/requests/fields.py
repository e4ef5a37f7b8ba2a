"""The types of fields in requests, and the fields that all requests share."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Annotated, Any, Literal, TypeAlias, TypeVar, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    JsonValue,
)
from pydantic.json_schema import SkipJsonSchema
from pydantic_core.core_schema import CoreSchema, tagged_union_schema

from service.errors import invalid
from service.front import BOUND_SECONDS, PlanOptions
from service.instance import CLOSED, RouteEnds
from service.objectives import MOST_OBJECTIVES, OBJECTIVES
from service.preferences import from_angles, spread

# Between these, lengths and hypervolumes neither overflow nor vanish.
LARGEST = 1e150
SMALLEST = 1e-150
LARGEST_INTEGER = 2**31 - 1
LONGEST_TEXT = 100  # characters of an id, a name or a unit
# No control characters, line ends, marks of direction or byte order marks.
PRINTABLE = r"^[^\u0000-\u001f\u007f-\u009f\u2028-\u202e\u2066-\u2069\ufeff]+$"


START = (
    "the city at which every tour begins in the answer; open routes start there, or anywhere if it"
    " is null"
)
END = "the city at which open routes end; null for any city"
Geometry = Literal["straight", "roads"]
GEOMETRY = (
    "in GeoJSON, whether the lines of tours lead straight from stop to stop, or along the streets"
    " that a routing engine knows"
)


def _integer(value: object) -> object:
    """Return a float without a fraction as an integer; JSON schemas call 3.0 an integer, too."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


class _Time:
    """The annotation of a number that is a time: agents may write it as a text, as 10:00."""

    def __get_pydantic_core_schema__(
        self, number: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Return the schema of the number, with a mark for `is_time`."""
        schema: Any = handler(number)
        schema["metadata"] = {**schema.get("metadata", {}), "is_time": True}
        return schema


def is_time(schema: CoreSchema) -> bool:
    """Return whether a schema is of a number that is a time."""
    return bool(schema.get("metadata", {}).get("is_time"))


def at_most(items: int) -> Any:
    """Return the annotation of a list of at most so many items, which ends at a wrong one."""
    return Field(max_length=items, fail_fast=True)


Each = TypeVar("Each")
# A member that is absent, never null, where there is none.
Maybe: TypeAlias = Each | SkipJsonSchema[None]
# Lists whose validation ends at the first item that is wrong.
Items = Annotated[list[Each], Field(fail_fast=True)]
SomeItems = Annotated[list[Each], Field(min_length=1, fail_fast=True)]
Pair = Annotated[list[Each], Field(min_length=2, max_length=2, fail_fast=True)]
OneEach = Annotated[  # for each objective
    list[Each], Field(min_length=OBJECTIVES, max_length=MOST_OBJECTIVES, fail_fast=True)
]
OneEachOfCosts = Annotated[  # for each objective that has costs
    list[Each], Field(min_length=1, max_length=MOST_OBJECTIVES, fail_fast=True)
]
OneForBoth = Annotated[  # the same where there are two
    list[Each], Field(min_length=OBJECTIVES, max_length=OBJECTIVES, fail_fast=True)
]
Angle = Annotated[float, Field(ge=0, le=90, allow_inf_nan=False)]
Direction = Annotated[  # for each objective a part of it; not all of them 0
    list[Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)]],
    Field(min_length=OBJECTIVES, max_length=MOST_OBJECTIVES, fail_fast=True),
]
Share = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
Cost = Annotated[float, Field(ge=0, le=LARGEST, allow_inf_nan=False)]
Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST, allow_inf_nan=False)]
PositiveNumber = Annotated[float, Field(ge=SMALLEST, le=LARGEST, allow_inf_nan=False)]
PlanePoint = Pair[Number]
AsInteger = BeforeValidator(_integer)
IS_TIME = _Time()
Time = Annotated[Cost, IS_TIME]  # in the unit of the clock
PositiveTime = Annotated[PositiveNumber, IS_TIME]
ABSENT: dict[str, JsonValue] = {"not": {}}  # of a member that must not be there
# AsInteger comes last: in front of the bounds it would hide them from the OpenAPI document.
PositiveInteger = Annotated[int, Field(ge=1, le=LARGEST_INTEGER), AsInteger]
NonNegativeInteger = Annotated[int, Field(ge=0, le=LARGEST_INTEGER), AsInteger]
Text = Annotated[str, Field(min_length=1, max_length=LONGEST_TEXT, pattern=PRINTABLE)]
# Only the type of the numbers is checked here, and the rest once they are an array: half a million
# are too many to check one by one.
ArrayRows = Items[Items[float]]
# Costs from each city to each; null forbids the leg.
CostRows = Items[Items[float | None]]
NO_WAY = "null where there is no way; the diagonal is ignored"


@dataclass(frozen=True)
class Branch:
    """The annotation of a union: the errors of a value are those of one of its types alone.

    Args:
        of: Returns the number of that type in the union, from 0; of two types, whether it is the
            second. It is given JSON or, where a form is written as JSON again, a value of a type.
    """

    of: Callable[[Any], int]

    def __get_pydantic_core_schema__(self, union: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return a union whose tags have brackets: `validation` leaves them out of places."""
        types = {f"[{k}]": handler.generate_schema(each) for k, each in enumerate(get_args(union))}
        return tagged_union_schema(types, lambda value: f"[{int(self.of(value))}]")


IS_TEXT = Branch(lambda value: isinstance(value, str))
IS_LIST = Branch(lambda value: isinstance(value, list))
IS_OBJECT = Branch(lambda value: isinstance(value, dict | BaseModel))


def _form_of_preferences(value: object) -> int:
    if not isinstance(value, list):
        return 0
    return 2 if value and isinstance(value[0], list) else 1


@dataclass(frozen=True, kw_only=True)
class Offered:
    """The annotation of a field that is offered beside HTTP.

    Args:
        option: The help on its option of the command, "" for its description; None for no option.
        each: What a value of an option looks like that may be given several times.
        flag: The name of a flag that stands for false, in place of an option or an input.
        label: The label of its input on the page; None for none.
        more: Its rank among the inputs that few need, from 1; 0 if it is none of them.
        initial: What is in the input at first, if it is not the default.
    """

    option: str | None = None
    each: str | None = None
    flag: str | None = None
    label: str | None = None
    more: int = 0
    initial: str | None = None


def shared_values(form: BaseModel, of: type[Any]) -> dict[str, Any]:
    """Return the values of the fields that a form shares with a dataclass, by name.

    Lists become tuples. A field that is None has the default of the dataclass.
    """
    names = [each.name for each in fields(of) if each.name in type(form).model_fields]
    given = {name: getattr(form, name) for name in names}
    return {k: tuple(v) if isinstance(v, list) else v for k, v in given.items() if v is not None}


def optional(description: str) -> Any:
    """Return a field that is None where it was not given."""
    return Field(default=None, description=description)


def unless_given(default: object, description: str) -> Any:
    """Return a field whose default depends on others, so that its JSON schema has none."""
    return Field(default=default, json_schema_extra=without_default, description=description)


def empty_list(description: str) -> Any:
    """Return a field that is an empty list where it was not given."""
    return Field(default_factory=list, description=description)


def without_default(schema: dict[str, Any]) -> None:
    """Leave a default that depends on other fields out of the JSON schema of a field."""
    del schema["default"]


def one_of(*choices: str, **of_some: JsonValue) -> ConfigDict:
    """Return the configuration of a form that must have exactly one of these members.

    Args:
        choices: The members; with a `+` between those that belong together.
        of_some: The schema that a form must fit as well if it has a member, by that member.
    """
    return ConfigDict(json_schema_extra=rules_of(choices, of_some))


def rules_of(choices: Iterable[str], of_some: Mapping[str, JsonValue]) -> dict[str, JsonValue]:
    """Return the parts of a JSON schema that say what `one_of` does."""
    alone: list[JsonValue] = [{"required": [*names.split("+")]} for names in choices]
    # Inside of `allOf`, or generators of clients would make a union of it, and no type.
    return {"allOf": [{"oneOf": alone}], "dependentSchemas": {**of_some}}


class StrictModel(BaseModel):
    """A part of a request, which has no other fields and takes no value for one of another type.

    Its validator is built by the first `parse_json`: those of all requests take 0.2 s together, and
    a process that plans often needs one of them, or none.
    """

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, defer_build=True)


class SearchFields(StrictModel):
    """The fields of every request: how long to plan, and how much to return."""

    time_limit: Annotated[float, Offered(option="", label="Seconds of planning", initial="3")] = (
        Field(
            default=1.0,
            ge=0,
            allow_inf_nan=False,
            description="seconds of all planning, at most; 0 asks for what the network builds"
            " alone",
        )
    )
    size: Annotated[PositiveInteger, Offered(option="", label="Tours")] = Field(
        default=100, description="the most tours, or plans, to return"
    )
    reference_point: list[PositiveNumber] = Field(
        default_factory=list,
        min_length=OBJECTIVES,
        max_length=MOST_OBJECTIVES,
        description="the reference point of the hypervolume; by default, for tours the number of"
        " cities times the scale, for plans lengths above those of all sensible plans",
    )
    seed: Annotated[NonNegativeInteger, Offered(option="", label="Seed", more=2)] = Field(
        default=0, description="the seed of everything random in the search"
    )

    def options(self, objectives: int = OBJECTIVES) -> PlanOptions:
        """Return the options for the planner of a front under this number of objectives.

        Raises:
            Refusal: The reference point is not of as many.
        """
        point = self.reference_point
        if point and len(point) != objectives:
            came = len(point)
            raise invalid("reference_point", "number-each", objectives=objectives, came=came)
        return PlanOptions(
            directions=np.empty((0, objectives)),
            size=self.size,
            time_limit=self.time_limit,
            reference_point=np.array(point) if point else None,
            seed=self.seed,
        )


class PlanFields(SearchFields):
    """The fields of every request for a front of tours."""

    preferences: Annotated[
        PositiveInteger | SomeItems[Angle] | SomeItems[Direction],
        Branch(_form_of_preferences),
        Offered(label="Trade-offs for the network", more=1),
    ] = unless_given(
        100,
        "the directions along which the network builds tours: the number of evenly"
        " spread ones; of two objectives angles in degrees; or for each a number for every"
        " objective. By default 100 if time_limit is 0, else as many as fit into a tenth of it,"
        " maybe none",
    )
    repairs: Annotated[NonNegativeInteger, Offered(option="")] = unless_given(
        LARGEST_INTEGER,
        "how often the network cuts each of its tours open and joins it again, which"
        " never makes the tour worse; tours found on the way count for the front, too. By"
        " default 0 with a time limit, else as many as are worth their time: with"
        " coordinates an eighth of the number of cities and at least 3, a fifth under more than"
        " two objectives, with matrices a third and at least 2",
    )
    arrivals: bool = Field(
        default=False, description="whether each tour comes with all its lengths up to each stop"
    )
    bound: Annotated[
        bool, Offered(label="Say how far from the best possible it may be", more=1)
    ] = Field(
        default=False,
        description=f"whether to compute, in up to {BOUND_SECONDS:g} s, a bound that no hypervolume"
        " exceeds",
    )
    actor: Annotated[str, Offered(option="The network, one of `paretour actors`.")] = unless_given(
        "",
        "the network that builds the tours; by default pa-one for coordinates and"
        " pa-one-matrix for matrices",
    )

    @property
    def requested_actor(self) -> str | None:
        """The name of the actor; None where the request leaves the choice to the service."""
        return self.actor if "actor" in self.model_fields_set else None

    def _directions(self, m: int) -> NDArray[np.float64]:
        """Return the directions of the preferences, shape (k, m), under m objectives."""
        given = self.preferences
        if isinstance(given, int):
            return spread(given, m)
        rows = [each for each in given if isinstance(each, list)]
        if not rows:
            if m > OBJECTIVES:
                raise invalid("preferences/0", "angle-of-several", objectives=m, came=given[0])
            return from_angles(np.array(given))
        for index, row in enumerate(rows):
            if len(row) != m or not any(row):
                part = f"preferences/{index}"
                raise invalid(part, "no-direction", objectives=m, given=str(row))
        directions = np.array(rows)
        return directions / np.linalg.norm(directions, axis=1, keepdims=True)

    def options(self, objectives: int = OBJECTIVES) -> PlanOptions:
        """Return the options for the planner of a front under this number of objectives."""
        given = "repairs" in self.model_fields_set
        return replace(
            super().options(objectives),
            directions=self._directions(objectives),
            fewer="preferences" not in self.model_fields_set,
            repairs=self.repairs if given or self.time_limit == 0 else 0,
            fewer_repairs=not given,
            bound=self.bound,
        )


OPEN = Offered(
    option="Plan open routes, which do not return to their start.",
    flag="open",
    label="Open route: no way back to the start",
)
AT_START = Offered(
    option="The city or place at which reported tours begin, by index or id; with --open also"
    " `any`.",
    label="Start",
    initial="1",
)
AT_END = Offered(
    option="The city or place at which open routes end, by index or id; by default any.",
    label="End elsewhere",
)


class PlanRequest(PlanFields):
    """A request for a front of a new instance: adds the ends of its tours, and initial tours."""

    closed: Annotated[bool, OPEN] = Field(
        default=True,
        description="whether tours return to where they began; if not, they are open routes",
    )
    start: Annotated[NonNegativeInteger | None, AT_START] = Field(default=0, description=START)
    end: Annotated[NonNegativeInteger | None, AT_END] = optional(END)
    initial_tours: SomeItems[Items[NonNegativeInteger]] = empty_list(
        "tours that the front must dominate or equal"
    )

    @property
    def ends(self) -> RouteEnds:
        """Whether tours are closed, and where open routes start and end."""
        if self.closed:
            return CLOSED
        return RouteEnds(closed=False, start=self.start, end=self.end)

    def options(self, objectives: int = OBJECTIVES) -> PlanOptions:
        """Return the options for the planner of a front under this number of objectives."""
        first = np.array(self.initial_tours) if self.initial_tours else None
        return replace(super().options(objectives), start=self.start or 0, initial_tours=first)
