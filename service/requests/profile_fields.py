"""The fields of a fleet's costs that differ between vehicles: by their profile."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from service.errors import invalid
from service.errors.faults import show
from service.requests.arrays import costs_between
from service.requests.day_fields import (
    SliceItems,
    TimedObjectiveItem,
    check_slices,
    read_slices,
)
from service.requests.fields import NO_WAY, CostRows, StrictModel, Text, at_most, empty_list, one_of
from service.requests.stop_fields import check_unique
from service.requests.stops import (
    ROAD_MEASURES,
    FixedSource,
    Matrix,
    Measured,
    Slices,
    Source,
    Stop,
    Traffic,
    with_base,
)
from service.requests.validation import nearest

Array = NDArray[np.float64]
MOST_PROFILES = 10
Profile = str | None  # of a vehicle; without one it drives as the costs say for all


class ProfileMatrixItem(StrictModel):
    """The costs of the legs to vehicles of a profile: a matrix, or one for each slice of a day.

    Where others have slices, a matrix holds all day.
    """

    model_config = one_of("matrix", "slices")

    profile: Text = Field(description="the `profile` of these vehicles")
    matrix: CostRows = empty_list(f"the costs from each stop (row) to each (column), {NO_WAY}")
    slices: SliceItems = empty_list(
        "in place of one matrix: one for each slice of the day, as of an objective; of all profiles"
        " that have some they begin at the same times"
    )

    def source(self, part: str, n: int) -> Matrix | Slices:
        """Return the source of the costs between n stops.

        Raises:
            Refusal: There is not exactly one source, or it does not fit the stops.
        """
        if bool(self.matrix) == bool(self.slices):
            given = "both" if self.matrix else "none"
            raise invalid(part, "one-form", forms="matrix and slices", given=given)
        if self.slices:
            return read_slices(self.slices, f"{part}/slices", n)
        return Matrix(costs_between(self.matrix, f"{part}/matrix", n))


class ProfileCostsItem(TimedObjectiveItem):
    """A source of costs that may differ between the profiles of vehicles.

    It has exactly one of matrix, matrices, coordinates, from, slices and breakpoints.
    """

    matrices: Annotated[list[ProfileMatrixItem], at_most(MOST_PROFILES)] = empty_list(
        "in place of one matrix: one for each `profile` of vehicles, as for cars and trucks"
    )

    @property
    def changes(self) -> bool:
        """Whether its costs change over the day."""
        return super().changes or any(each.slices for each in self.matrices)

    @property
    def by_road(self) -> bool:
        """Whether its costs are by road, so that each profile has its own."""
        return "measure" in self.model_fields_set and self.measure in ROAD_MEASURES

    def sources_by(
        self, part: str, stops: Sequence[Stop], profiles: Sequence[Profile]
    ) -> list[Source]:
        """Return the source of the costs between these stops, for each profile.

        Raises:
            Refusal: As of `source`; or matrices do not fit the stops.
        """
        if self.sources == ["matrices"]:
            own = self._sources_of_own(part, len(stops))
            return [own[profile] for profile in profiles]
        source = self.source(part, stops)
        if isinstance(source, Traffic):
            check_slices(f"{part}/traffic/at", len(source.begins), len(stops), len(profiles))
            return [replace(source, profile=profile) for profile in profiles]
        return [with_base(source, partial(_by_profile, profile=profile)) for profile in profiles]

    def _sources_of_own(self, part: str, n: int) -> dict[Profile, Source]:
        """Return the source of the costs between n stops that each profile has for itself."""
        items = enumerate(self.matrices)
        own = {each.profile: each.source(f"{part}/matrices/{k}", n) for k, each in items}
        sliced = next((each for each in own.values() if isinstance(each, Slices)), None)
        if sliced is None:
            return {
                profile: self.factored(part, each)
                for profile, each in own.items()
                if isinstance(each, Matrix)
            }
        for name in ("over_the_day", "traffic"):
            if getattr(self, name):
                raise invalid(f"{part}/{name}", "not-beside", member="slices")
        for k, each in enumerate(own.values()):
            if isinstance(each, Slices) and not np.array_equal(each.begins, sliced.begins):
                raise invalid(f"{part}/matrices/{k}/slices", "other-slices")
        check_slices(f"{part}/matrices", len(sliced.begins), n, len(own))
        return {profile: _all_day(each, sliced.begins) for profile, each in own.items()}


def _all_day(source: Matrix | Slices, begins: Array) -> Slices:
    """Return costs in each slice of the day: of a matrix, the same in all."""
    if isinstance(source, Slices):
        return source
    return Slices(begins, np.repeat(source.costs[np.newaxis], len(begins), axis=0))


def _by_profile(base: FixedSource, profile: Profile) -> FixedSource:
    """Return a source for vehicles of a profile, which differs by road."""
    if isinstance(base, Measured) and base.measure in ROAD_MEASURES:
        return replace(base, profile=profile)
    return base


def check_profiles(profiles: Sequence[Profile], items: Mapping[str, ProfileCostsItem]) -> None:
    """Raise a refusal unless each profile of vehicles has its costs, and says something.

    Args:
        profiles: The profile of each item of vehicles.
        items: All costs, by their part of the request.
    """
    for part, item in items.items():
        check_unique((each.profile for each in item.matrices), f"{part}/matrices", "profile")
    by_matrices = [item for item in items.values() if item.matrices]
    by_profile = by_matrices or any(item.by_road for item in items.values())
    for index, profile in enumerate(profiles):
        part = f"vehicles/{index}/profile"
        for item in by_matrices:
            _check_known(part, profile, item)
        if profile is not None and not by_profile:
            raise invalid(part, "profile-of-nothing")
    if len(set(profiles)) > MOST_PROFILES:
        came = len(set(profiles))
        raise invalid("vehicles", "too-many-profiles", limit=MOST_PROFILES, came=came)


def _check_known(part: str, profile: Profile, item: ProfileCostsItem) -> None:
    """Raise a refusal unless there is a matrix of a profile."""
    known = [each.profile for each in item.matrices]
    if profile in known:
        return
    values = {"objective": item.name, "names": " or ".join(map(show, known))}
    if profile is None:
        raise invalid(part, "profile-needed", **values)
    raise invalid(part, "not-a-profile", **values, came=profile, near=nearest(profile, known))


def check_road_profiles(
    profiles: Sequence[Profile], items: Iterable[ProfileCostsItem], known: Sequence[str]
) -> None:
    """Raise a refusal of a profile that the operator's routing engine does not know."""
    if not any(item.by_road for item in items):
        return
    for index, profile in enumerate(profiles):
        if profile is not None and profile not in known:
            part, near = f"vehicles/{index}/profile", nearest(profile, known)
            names = " or ".join(map(show, known))
            code = "not-a-road-profile" if known else "no-road-profiles"
            raise invalid(part, code, names=names, came=profile, near=near)
