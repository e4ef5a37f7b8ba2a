"""The fields of a coverage request about the time of day, and what they say about robots."""

from dataclasses import replace
from typing import Annotated

from pydantic import Field

from service.coverage.coverage import RobotHours
from service.errors import invalid
from service.objectives import MOST_OBJECTIVES
from service.requests.day_fields import Departure, Factors, check_factors, range_of
from service.requests.fields import StrictModel, empty_list, optional

_LEAST_SPEED, _MOST_SPEED = 0.001, 100.0


class MapDayFields(StrictModel):
    """When robots leave, how fast they are, and how costs change over the day."""

    departure: Departure | None = optional(
        "when tours or robots begin, in seconds of the day: a time, or the earliest and the latest"
        " one; each then begins at its best time between them. Needs robot_speed and over_the_day"
    )
    robot_speed: (
        Annotated[float, Field(ge=_LEAST_SPEED, le=_MOST_SPEED, allow_inf_nan=False)] | None
    ) = optional("in metres a second, with a departure: the first objective is then seconds")
    over_the_day: Annotated[list[Factors], Field(max_length=MOST_OBJECTIVES, fail_fast=True)] = (
        empty_list(
            "with a departure, for each objective pairs of a second of the day and a factor: from"
            " then on costs are those of the map times the factor; none where they do not change."
            " Robots without a second objective have one list"
        )
    )

    def hours(self, costs: int) -> RobotHours | None:
        """Return the day, where there are so many different costs; None without one.

        Raises:
            Refusal: One of the fields is missing, or times or factors are out of order or range.
        """
        if self.departure is None and self.robot_speed is None and not self.over_the_day:
            return None
        if self.departure is None:
            raise invalid("departure", "no-departure")
        if self.robot_speed is None:
            raise invalid("robot_speed", "missing")
        if len(self.over_the_day) != costs:
            came = len(self.over_the_day)
            raise invalid("over_the_day", "factors-of-each", objectives=costs, came=came)
        for m, pairs in enumerate(self.over_the_day):
            check_factors(f"over_the_day/{m}", pairs)
        earliest, latest = range_of(self.departure)
        factors = tuple(
            tuple((time, factor) for time, factor in pairs) for pairs in self.over_the_day
        )
        return RobotHours(speed=self.robot_speed, earliest=earliest, latest=latest, factors=factors)


def hours_from(hours: RobotHours | None, now: float | None) -> RobotHours | None:
    """Return the day of a way that goes on now; None if costs do not change over the day.

    Raises:
        Refusal: The present time is missing, or it is given where none counts.
    """
    if hours is None:
        if now is not None:
            raise invalid("now", "day-unchanging")
        return None
    if now is None:
        raise invalid("now", "no-now")
    return replace(hours, earliest=now, latest=now)
