"""The fields of stops and objectives in requests, and their conversion to stops and sources."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import ConfigDict, Field, JsonValue

from service.errors import invalid
from service.objectives import Objective
from service.requests.arrays import check_rows, costs_between
from service.requests.fields import (
    ABSENT,
    IS_TEXT,
    NO_WAY,
    CostRows,
    NonNegativeInteger,
    PlanePoint,
    SomeItems,
    StrictModel,
    Text,
    empty_list,
    optional,
    rules_of,
    without_default,
)
from service.requests.stops import (
    UNITS,
    FixedSource,
    Matrix,
    Measure,
    Measured,
    Plane,
    Source,
    Stop,
)
from service.requests.validation import nearest

StopReference = Annotated[NonNegativeInteger | Text, IS_TEXT]
# In km/h. The least is a metre in an hour, which keeps times finite.
Speed = Annotated[float, Field(ge=0.001, le=1000, allow_inf_nan=False)]
Longitude = Annotated[float, Field(ge=-180, le=180, allow_inf_nan=False)]
Latitude = Annotated[float, Field(ge=-90, le=90, allow_inf_nan=False)]
# All members that are sources of costs, in the order of our sentences. A form has some of them.
SOURCES = ("matrix", "matrices", "coordinates", "from", "slices", "breakpoints", "days")
# What goes with a member of an objective, and what does not.
_RULES: Mapping[str, JsonValue] = {
    "speed": {"required": ["from"], "properties": {"from": {"const": "great_circle"}}},
    "traffic": {
        "required": ["from"],
        "properties": {"from": {"const": "road_time"}, "over_the_day": ABSENT},
    },
    "slices": {"properties": {"over_the_day": ABSENT}},
    "breakpoints": {"properties": {"over_the_day": ABSENT}},
    "days": {"properties": {"over_the_day": ABSENT, "spread": ABSENT}},
    "measure": {"properties": {"over": ABSENT, "over_the_day": ABSENT}},
}


class NamedStop(StrictModel):
    """A stop by its id, and where it is on the earth."""

    id: Text = Field(description="comes back in every answer; no two stops share one")
    location: tuple[Longitude, Latitude] | None = optional(
        "longitude and latitude in degrees, WGS84"
    )


def _one_source(schema: dict[str, Any]) -> None:
    """Add to the schema of an objective that it has one source of costs, or is another measure."""
    choices = [name for name in schema["properties"] if name in (*SOURCES, "measure")]
    of_some = {name: rule for name, rule in _RULES.items() if name in schema["properties"]}
    schema |= rules_of(choices, of_some)


class ObjectiveItem(StrictModel):
    """An objective by its name, and the source of its costs: matrix, coordinates or from.

    Forms with more sources have their members too.
    """

    model_config = ConfigDict(json_schema_extra=_one_source)

    name: Text = Field(description="of the objective, in answers and charts")
    unit: Text | None = optional("of its costs, in answers and charts")
    # An empty default means that the field was not given: no caller can give an empty array.
    matrix: CostRows = empty_list(f"the costs from each stop (row) to each (column), {NO_WAY}")
    coordinates: SomeItems[PlanePoint] = empty_list(
        "x and y of each stop in a plane; its distances"
    )
    measure: Measure = Field(
        default="great_circle",
        alias="from",
        json_schema_extra=without_default,
        description="the measure between the locations of stops: metres along a great circle, or"
        " seconds or metres by road",
    )
    speed: Speed | None = optional(
        "km/h; with `from` great_circle, the costs are the seconds that its metres take at this"
        " speed"
    )

    @property
    def sources(self) -> list[str]:
        """The names of the members that are sources of costs, of those that were given."""
        # Other lists that are empty count as not given. A matrix without rows is refused as such.
        return [
            shown
            for name, shown in self._choices().items()
            if name in self.model_fields_set and (getattr(self, name) or name == "matrix")
        ]

    @classmethod
    def _choices(cls) -> dict[str, str]:
        """Return the names of all members that are sources of costs, by those of their fields."""
        named = {name: each.alias or name for name, each in cls.model_fields.items()}
        return {name: shown for name, shown in named.items() if shown in SOURCES}

    def objective(self, part: str) -> Objective:
        """Return the objective, in its measure's unit where it has one.

        Raises:
            Refusal: The unit is not that of the measure, or the measure has no speed.
        """
        self._check_speed(part)
        if "measure" not in self.model_fields_set:
            return Objective(self.name, self.unit)
        at_a_speed = self.speed is not None
        unit = "s" if at_a_speed else UNITS[self.measure]
        if self.unit not in (None, unit):
            measure = f"{self.measure} at a speed" if at_a_speed else self.measure
            raise invalid(f"{part}/unit", "other-unit", unit=unit, measure=measure, came=self.unit)
        return Objective(self.name, unit)

    def _check_speed(self, part: str) -> None:
        """Raise a refusal of a speed without great_circle as the source of costs."""
        sources = self.sources
        if self.speed is None or ("from" in sources and self.measure == "great_circle"):
            return
        came = f"from {self.measure}" if "from" in sources else " and ".join(sources) or "no source"
        raise invalid(f"{part}/speed", "needs-from", measure="great_circle", given=came)

    def source(self, part: str, stops: Sequence[Stop]) -> Source:
        """Return the source of the costs between these stops.

        Raises:
            Refusal: There is not exactly one source, or it does not fit the stops.
        """
        return self.fixed_source(part, stops)

    def fixed_source(self, part: str, stops: Sequence[Stop]) -> FixedSource:
        """Return the source of costs that are the same all day, as `source` does."""
        match self.sources:
            case ["matrix"]:
                return Matrix(costs_between(self.matrix, f"{part}/matrix", len(stops)))
            case ["coordinates"]:
                check_rows(f"{part}/coordinates", len(stops), len(self.coordinates))
                return Plane(np.array(self.coordinates, dtype=np.float64))
            case ["from"]:
                _check_located(f"{part}/from", self.measure, stops)
                return Measured(self.measure, self.speed)
            case sources:
                came = " and ".join(sources) or "none"
                *choices, last = sorted(self._choices().values(), key=SOURCES.index)
                known = f"{', '.join(choices)} and {last}"
                raise invalid(part, "not-one-source", sources=known, given=came)


def read_stops(items: Sequence[NamedStop]) -> tuple[Stop, ...]:
    """Return the stops of a request.

    Raises:
        Refusal: Two have the same id.
    """
    check_unique([item.id for item in items], "stops")
    return tuple(Stop(item.id, item.location) for item in items)


def read_objectives(items: Sequence[ObjectiveItem]) -> tuple[Objective, ...]:
    """Return the objectives of a request.

    Raises:
        Refusal: Two have the same name, or one has a unit other than its measure's.
    """
    check_unique([item.name for item in items], "objectives", "name")
    return tuple(item.objective(f"objectives/{m}") for m, item in enumerate(items))


def read_sources(items: Sequence[ObjectiveItem], stops: Sequence[Stop]) -> list[Source]:
    """Return the source of the costs of each objective between these stops.

    Raises:
        Refusal: An objective does not have exactly one source, or it does not fit the stops.
    """
    return [item.source(f"objectives/{m}", stops) for m, item in enumerate(items)]


def check_unique(names: Iterable[str], items: str, member: str = "id") -> None:
    """Raise a refusal where two items of a list, as stops, have the same id or name."""
    first: dict[str, int] = {}
    for index, name in enumerate(names):
        if (other := first.setdefault(name, index)) != index:
            part = f"{items}/{index}/{member}"
            raise invalid(part, "not-unique", other=f"/{items}/{other}", came=name)


def find_index(
    reference: int | str,
    ids: Mapping[str, int],
    part: str,
    n: int | None = None,
    noun: str = "a stop",
) -> int:
    """Return the index of a stop that is named by its id or its index.

    Args:
        ids: The index of each stop by its id; empty where the cities have no ids.
        part: The place of the reference in the request, such as initial_tours/0/2.
        n: The number of stops that an index may be of; without it, an index is not checked.
        noun: What these stops are, for the sentence.

    Raises:
        Refusal: No stop has this id or index.
    """
    if isinstance(reference, int):
        if n is not None and reference >= n:
            raise invalid(part, "not-an-index", noun=noun, last=n - 1, came=reference)
        return reference
    if reference in ids:
        return ids[reference]
    if not ids:
        raise invalid(part, "no-ids", came=reference)
    raise invalid(part, "not-an-id", came=reference, near=nearest(reference, ids))


def find_indexes(
    references: Iterable[int | str], ids: Mapping[str, int], part: str
) -> tuple[int, ...]:
    """Return the indexes of stops that all have ids; raises what `find_index` does."""
    return tuple(
        find_index(each, ids, f"{part}/{i}", len(ids)) for i, each in enumerate(references)
    )


def _check_located(part: str, measure: Measure, stops: Sequence[Stop]) -> None:
    """Raise a refusal where a measure needs the location of a stop that has none."""
    for index, stop in enumerate(stops):
        if stop.location is None:
            values = {"other": f"/{part}", "measure": measure}
            raise invalid(f"stops/{index}/location", "no-location", **values)
