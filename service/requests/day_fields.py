"""The fields of requests about the time of day, and what they say about stops and costs."""

from collections.abc import Sequence
from datetime import date
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from service.errors import invalid
from service.errors.faults import show
from service.objectives import Objective
from service.reliability.spread import Spread
from service.requests.arrays import costs_between
from service.requests.breakpoint_fields import LATEST as _LATEST
from service.requests.breakpoint_fields import Rows, TimeOfDay, read_breakpoints
from service.requests.fields import (
    IS_OBJECT,
    IS_TIME,
    NO_WAY,
    CostRows,
    Pair,
    StrictModel,
    Text,
    empty_list,
    optional,
)
from service.requests.spread_fields import DaysFields, SpreadFields
from service.requests.stop_fields import NamedStop, ObjectiveItem
from service.requests.stops import (
    FixedSource,
    Hours,
    Matrix,
    Measured,
    OverTheDay,
    Slices,
    Source,
    Stop,
    Traffic,
)

_YEARS = (1970, 2999)  # that Valhalla reads
_MOST_TIMES = 2**23  # of travel, in all slices of one objective
_MOST_SLICES = 100  # every quarter of an hour, and a few more
_LEAST_FACTOR, _MOST_FACTOR = 0.01, 100.0
Factor = Annotated[float, Field(ge=0, allow_inf_nan=False), IS_TIME]  # its pair has one
Factors = Annotated[list[Pair[Factor]], Field(max_length=_MOST_SLICES, fail_fast=True)]


class SliceItem(StrictModel):
    """A slice of the day, and the costs in it."""

    begins: TimeOfDay = Field(alias="from", description="when it begins, in seconds of the day")
    matrix: CostRows = Field(
        description=f"the costs from each stop (row) to each (column), {NO_WAY}; a leg that one"
        " slice has no way for is never driven"
    )


SliceItems = Annotated[list[SliceItem], Field(max_length=_MOST_SLICES, fail_fast=True)]


class TrafficItem(StrictModel):
    """Which times of travel a routing engine is asked for."""

    day: str = Field(
        alias="date", description="the date, as 2026-11-27", json_schema_extra={"format": "date"}
    )
    begins: Annotated[list[TimeOfDay], Field(max_length=_MOST_SLICES, fail_fast=True)] = Field(
        alias="at",
        min_length=1,
        description="seconds of that day, whole minutes: from each of them on, the costs are the"
        " times that the engine knows for it",
    )

    def source(self, part: str, n: int) -> Traffic:
        """Return the source of the costs between n stops.

        Raises:
            Refusal: The date is none, or the times are out of order, no minutes, or too many.
        """
        _check_times(f"{part}/at", [f"{k}" for k in range(len(self.begins))], self.begins)
        for k, seconds in enumerate(self.begins):
            if seconds % 60:
                raise invalid(f"{part}/at/{k}", "not-a-minute", came=seconds)
        check_slices(f"{part}/at", len(self.begins), n)
        return Traffic(self._date(f"{part}/date"), tuple(self.begins))

    def _date(self, part: str) -> str:
        try:
            found = date.fromisoformat(self.day)
        except ValueError:
            raise invalid(part, "not-a-date", came=self.day) from None
        first, last = _YEARS
        if not first <= found.year <= last:
            raise invalid(part, "not-these-years", first=first, last=last, given=str(found))
        return found.isoformat()


def check_slices(part: str, times: int, n: int, profiles: int = 1) -> None:
    """Raise a refusal of too many slices of the day between n stops, by some profiles."""
    most = max(1, _MOST_TIMES // (profiles * n**2))
    if times > most:
        raise invalid(part, "too-many-times", limit=most, stops=n, came=times)


class DepartureRange(StrictModel):
    """The times at which a tour may begin."""

    earliest: TimeOfDay = Field(description="in seconds of the day")
    latest: TimeOfDay = Field(description="in seconds of the day")


Departure = Annotated[TimeOfDay | DepartureRange, IS_OBJECT]


class StopItem(NamedStop):
    """A stop, and how long a visit takes."""

    service: TimeOfDay = Field(
        default=0.0, description="the seconds of a visit, where there is a departure"
    )


class TimedObjectiveItem(ObjectiveItem):
    """An objective, whose costs may change over the day."""

    over_the_day: Factors = empty_list(
        "pairs of a second of the day and a factor: from then on the costs are those of the"
        " source times the factor; the first one holds before it too"
    )
    slices: SliceItems = empty_list(
        "in place of one matrix: one for each slice of the day, which the next one ends; the first"
        " one holds before it too"
    )
    breakpoints: Rows = empty_list(
        "in place of a matrix, of times of travel: for each stop (row) and each other"
        f" (column) pairs of a second of the day and the seconds on the way from then on, {NO_WAY}."
        " Between two of them the seconds change evenly, and before the first and after the last"
        " they stay. Who leaves later must not arrive earlier"
    )

    traffic: TrafficItem | None = optional(
        "with `from` road_time: the historical traffic of the operator's routing engine"
    )

    @property
    def changes(self) -> bool:
        """Whether its costs change over the day."""
        return bool(self.over_the_day or self.slices or self.breakpoints or self.traffic)

    def source(self, part: str, stops: Sequence[Stop]) -> Source:
        """Return the source of the costs between these stops, over the day.

        Raises:
            Refusal: There is not exactly one source, it does not fit the stops, or times or factors
                are out of order or range.
        """
        if self.sources in (["slices"], ["breakpoints"]):
            return self._given(part, self.sources[0], len(stops))
        base = self.fixed_source(part, stops)
        if self.traffic is None or not isinstance(base, Measured):
            return self.factored(part, base)
        if base.measure != "road_time":
            raise invalid(f"{part}/traffic", "needs-from", measure="road_time", given=base.measure)
        if self.over_the_day:
            raise invalid(f"{part}/traffic", "not-beside", member="over_the_day")
        return self.traffic.source(f"{part}/traffic", len(stops))

    def factored(self, part: str, base: FixedSource) -> Source:
        """Return a source with the factors of the day, if there are any."""
        if self.traffic is not None:
            raise invalid(f"{part}/traffic", "needs-road-time")
        if not self.over_the_day:
            return base
        check_factors(f"{part}/over_the_day", self.over_the_day)
        begins, factors = np.array(self.over_the_day, np.float64).T.copy()
        return OverTheDay(base, begins, factors)

    def _given(self, part: str, source: str, n: int) -> Source:
        """Return the costs in slices or by breakpoints."""
        for name in ("over_the_day", "traffic"):
            if getattr(self, name):
                raise invalid(f"{part}/{name}", "not-beside", member=source)
        if source == "breakpoints":
            return read_breakpoints(f"{part}/breakpoints", self.breakpoints, n)
        return read_slices(self.slices, f"{part}/slices", n)


class SampledObjectiveItem(DaysFields, TimedObjectiveItem):
    """An objective, whose costs may be those of several days."""

    def fixed_source(self, part: str, stops: Sequence[Stop]) -> FixedSource:
        """Return the source of costs that are the same all day: of several days, their means."""
        if self.sources == ["days"]:
            return Matrix(self.costs_of_days(part, len(stops)).mean(axis=0))
        return super().fixed_source(part, stops)


class DayObjectiveItem(SampledObjectiveItem, SpreadFields):
    """An objective, whose costs may change over the day, or spread from day to day.

    It has exactly one source of costs: matrix, coordinates, from, slices, breakpoints or days.
    """

    def spread_of(self, part: str, n: int) -> Spread | None:
        """Return how the costs between n stops spread; None if they do not.

        Raises:
            Refusal: As of SpreadFields, or the costs change over the day as well.
        """
        if self.changes and (self.days or self.spread is not None):
            raise invalid(f"{part}/{'days' if self.days else 'spread'}", "spread-over-the-day")
        return super().spread_of(part, n)


def read_slices(items: Sequence[SliceItem], part: str, n: int) -> Slices:
    """Return the costs between n stops in slices of the day.

    Raises:
        Refusal: They are not in order, or a matrix is not of these stops.
    """
    begins = [item.begins for item in items]
    _check_times(part, [f"{k}/from" for k in range(len(begins))], begins)
    named = enumerate(items)
    matrices = [costs_between(item.matrix, f"{part}/{k}/matrix", n) for k, item in named]
    return Slices(np.array(begins), np.stack(matrices))


class DayFields(StrictModel):
    """The fields of a request for tours whose costs change over the day."""

    departure: Departure | None = optional(
        "when a tour begins, in seconds of the day: a time, or the earliest and the latest one;"
        " each tour then begins at its best time between them"
    )
    clock: Text | None = optional(
        "the name of the objective whose costs are seconds of travel; by default the first one that"
        " changes over the day, or else the first one in s"
    )


def check_factors(part: str, pairs: Sequence[Sequence[float]]) -> None:
    """Raise a refusal unless the times of pairs are ascending and their factors within bounds."""
    _check_times(part, [f"{k}/0" for k in range(len(pairs))], [time for time, _ in pairs])
    for k, (_, factor) in enumerate(pairs):
        if not _LEAST_FACTOR <= factor <= _MOST_FACTOR:
            bounds = {"least": _LEAST_FACTOR, "most": _MOST_FACTOR}
            raise invalid(f"{part}/{k}/1", "not-between", **bounds, came=factor)


def range_of(departure: float | DepartureRange) -> tuple[float, float]:
    """Return the earliest and the latest departure.

    Raises:
        Refusal: The latest one is before the earliest.
    """
    if not isinstance(departure, DepartureRange):
        return departure, departure
    earliest, latest = departure.earliest, departure.latest
    if latest < earliest:
        raise invalid("departure/latest", "too-early", earliest=earliest, came=latest)
    return earliest, latest


def read_hours(
    request: DayFields,
    stops: Sequence[StopItem],
    items: Sequence[TimedObjectiveItem],
    objectives: Sequence[Objective],
) -> Hours | None:
    """Return when tours begin and how long visits take; None without a departure.

    Raises:
        Refusal: A departure is missing, no objective is the clock, or its unit is not s.
    """
    if request.departure is None:
        _check_no_day(request, stops, items)
        return None
    earliest, latest = range_of(request.departure)
    service = np.array([stop.service for stop in stops], np.float64)
    return Hours(_clock(request, items, objectives), service, earliest, latest)


def _check_no_day(
    request: DayFields, stops: Sequence[StopItem], items: Sequence[TimedObjectiveItem]
) -> None:
    """Raise a refusal where a request has no departure, but needs one."""
    changing = any(item.changes for item in items)
    if changing or request.clock is not None or any(stop.service for stop in stops):
        raise invalid("departure", "no-departure")


def _clock(
    request: DayFields, items: Sequence[TimedObjectiveItem], objectives: Sequence[Objective]
) -> int:
    names = [objective.name for objective in objectives]
    if request.clock is not None:
        if request.clock not in names:
            known = " or ".join(map(show, names))
            raise invalid("clock", "not-an-objective", names=known, came=request.clock)
        clock = names.index(request.clock)
    else:
        changing: list[Any] = [m for m, item in enumerate(items) if item.changes]
        in_seconds = [m for m, objective in enumerate(objectives) if objective.unit == "s"]
        if not changing and not in_seconds:
            raise invalid("clock", "no-time")
        clock = [*changing, *in_seconds][0]
    check_in_seconds(objectives[clock], f"objectives/{clock}")
    return clock


def check_in_seconds(clock: Objective, part: str) -> None:
    """Raise a refusal unless the times of a clock over the day are seconds."""
    if clock.unit not in (None, "s"):
        raise invalid(f"{part}/unit", "not-in-seconds", came=clock.unit)


def _check_times(part: str, places: Sequence[str], times: Sequence[float]) -> None:
    """Raise a refusal unless times are ascending, and none is too late."""
    for k, place in enumerate(places):
        if times[k] > _LATEST:
            raise invalid(f"{part}/{place}", "too-late", latest=_LATEST, came=times[k])
        if k and times[k] <= times[k - 1]:
            raise invalid(f"{part}/{place}", "not-later", before=times[k - 1], came=times[k])
