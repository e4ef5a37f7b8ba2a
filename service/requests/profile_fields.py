"""The fields of a fleet's costs that differ between vehicles: by their profile."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Annotated, ClassVar

from pydantic import Field

from service.errors import invalid
from service.errors.faults import show
from service.requests.arrays import check_costs, cost_matrix
from service.requests.day_fields import OF_SOURCES, SOURCES, TimedObjectiveItem, check_traffic
from service.requests.fields import NO_WAY, CostRows, StrictModel, Text, one_of
from service.requests.stop_fields import check_rows, check_unique
from service.requests.stops import (
    ROAD_MEASURES,
    FixedSource,
    Matrix,
    Measured,
    Source,
    Stop,
    Traffic,
    with_base,
)
from service.requests.validation import nearest

MOST_PROFILES = 10
Profile = str | None  # of a vehicle; without one it drives as the costs say for all


class ProfileMatrixItem(StrictModel):
    """The costs of the legs to vehicles of a profile."""

    profile: Text = Field(description="the `profile` of these vehicles")
    matrix: CostRows = Field(
        description=f"the costs from each stop (row) to each (column), {NO_WAY}"
    )


class ProfileCostsItem(TimedObjectiveItem):
    """A source of costs that may differ between the profiles of vehicles.

    It has exactly one of matrix, matrices, coordinates, from, slices and breakpoints.
    """

    model_config = one_of(*SOURCES, "matrices", **OF_SOURCES)

    matrices: Annotated[
        list[ProfileMatrixItem], Field(max_length=MOST_PROFILES, fail_fast=True)
    ] = Field(
        default_factory=list,
        description="in place of one matrix: one for each `profile` of vehicles, as for cars and"
        " trucks",
    )

    choices: ClassVar[str] = "matrix, matrices, coordinates, from, slices and breakpoints"

    @property
    def sources(self) -> list[str]:
        """The names of the members that are sources of costs."""
        return [*super().sources, *(["matrices"] if self.matrices else [])]

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
            own: dict[Profile, Source] = {
                each.profile: self.factored(part, _matrix(each, f"{part}/matrices/{k}", len(stops)))
                for k, each in enumerate(self.matrices)
            }
            return [own[profile] for profile in profiles]
        source = self.source(part, stops)
        if isinstance(source, Traffic):
            check_traffic(f"{part}/traffic", len(source.begins), len(stops), len(profiles))
            return [replace(source, profile=profile) for profile in profiles]
        return [with_base(source, partial(_by_profile, profile=profile)) for profile in profiles]


def _by_profile(base: FixedSource, profile: Profile) -> FixedSource:
    """Return a source for vehicles of a profile, which differs by road."""
    if isinstance(base, Measured) and base.measure in ROAD_MEASURES:
        return replace(base, profile=profile)
    return base


def _matrix(item: ProfileMatrixItem, part: str, n: int) -> Matrix:
    check_rows(f"{part}/matrix", n, len(item.matrix))
    matrix = cost_matrix(item.matrix, f"{part}/matrix")
    check_costs(matrix, f"{part}/matrix")
    return Matrix(matrix)


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
