"""The matrices of VROOM's JSON: those of each profile of vehicles, between the stops."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from service.files.fleets import Objective, Stop, Vehicle
from service.files.planners.vroom_members import note_others, note_unused
from service.files.planners.vroom_mixed import Layers, is_cost, nameless
from service.files.reading import Source, quoted

Matrix = list[list[Any]]


@dataclass(frozen=True)
class Cut:
    """The matrices of a profile of vehicles, cut to the stops."""

    source: Source
    stops: Sequence[Stop]
    indexes: Sequence[Any]
    profile: str
    given: Mapping[str, Any]

    def matrix(self, name: str, scale: float = 1) -> Matrix:
        """Return the costs between the stops, by their indexes in a matrix."""
        source, indexes, matrix = self.source, self.indexes, self.given.get(name)
        source.check_count("stops with a matrix", source.bounds.matrix_cities, len(indexes))
        for at, index in enumerate(indexes):
            if not isinstance(index, int) or isinstance(index, bool) or index < 0:
                raise source.refusal("no-location-index", quoted(self.stops[at]["id"]))
        try:
            cut = [[matrix[row][column] for column in indexes] for row in indexes]  # type: ignore[index]
        except (TypeError, IndexError, KeyError):
            where = f"matrices/{self.profile[:60]}/{name}"
            raise source.refusal("matrix-too-small", where, most=max(indexes)) from None
        return cut if scale == 1 else [[scaled(each, scale) for each in row] for row in cut]


def scaled(value: Any, scale: float) -> Any:
    """Return a cost multiplied, if it is one."""
    return round(value * scale, 6) if is_cost(value) else value


def cuts_of(
    source: Source, problem: Mapping[str, Any], stops: Sequence[Stop], indexes: Sequence[Any]
) -> list[Cut]:
    """Return the matrices of each profile that the vehicles use; none if there are none."""
    matrices = problem.get("matrices")
    old = problem.get("matrix")
    if matrices and old:
        note_unused(source, "matrix", "the problem", "there are matrices")
    elif old:
        source.note("objectives", "matrix was read as durations in seconds, as VROOM 1.8 did.")
        return [Cut(source, stops, indexes, "matrix", {"durations": old})]
    if not isinstance(matrices, dict) or not matrices:
        return []
    used = profiles_of(problem["vehicles"])
    known = [each for each in used if each in matrices]
    taken = known if len(known) == len(used) else [*known, *matrices][:1]
    _note_others(source, taken, [*used, *matrices])
    for profile in taken:
        if not isinstance(given := matrices[profile], dict):
            raise source.refusal("not-an-object", f"matrices/{profile[:60]}", came=given)
        note_others(source, [given], "matrices")
    return [Cut(source, stops, indexes, profile, matrices[profile]) for profile in taken]


def _note_others(source: Source, taken: Sequence[str], profiles: Sequence[str]) -> None:
    """Note the profiles that are not used."""
    others = [quoted(each) for each in dict.fromkeys(profiles) if each not in taken]
    if others:
        used = " and ".join(map(quoted, taken))
        text = f"All vehicles use the matrices of {used}: {', '.join(others)} was not used."
        source.note("left-out", text)


def profiles_of(items: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the different profiles of VROOM's vehicles."""
    return list(dict.fromkeys(str(each.get("profile", "car")) for each in items))


def add_profiles(items: Sequence[Mapping[str, Any]], vehicles: Sequence[Vehicle]) -> None:
    """Add its profile to each vehicle."""
    for item, vehicle in zip(items, vehicles, strict=True):
        vehicle["profile"] = str(item.get("profile", "car"))


def layers_of(cuts: Sequence[Cut]) -> Layers:
    """Return all matrices, by profile if there are several."""
    time: Objective = {"name": "longest route", "unit": "s", **costs_of(cuts, "durations")}
    return Layers(time, known_costs(cuts, "distances"), known_costs(cuts, "costs"))


def known_costs(cuts: Sequence[Cut], name: str) -> Objective | None:
    """Return the matrices of a name as an objective without a name, if each profile has one."""
    having = [cut for cut in cuts if cut.given.get(name)]
    if having and len(having) < len(cuts):
        note_unused(having[0].source, name, "matrices", "not each profile has them")
    return costs_of(cuts, name) if having and len(having) == len(cuts) else None


def costs_of(cuts: Sequence[Cut], name: str) -> Objective:
    """Return the matrices of a name as an objective that has no name yet."""
    if len(cuts) == 1:
        return nameless(matrix=cuts[0].matrix(name))
    matrices = [{"profile": cut.profile, "matrix": cut.matrix(name)} for cut in cuts]
    return nameless(matrices=matrices)
