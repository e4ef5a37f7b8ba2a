"""The functions that compile each part of the compiled code, or load it."""

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import NamedTuple

from service.coverage import detours
from service.kinds import fleet
from service.kinds.parts import Part
from service.over_the_day import warm_up as day
from service.replanning import insertion
from service.search import warm_up as search

Compile = Callable[[], None]


class Compilation(NamedTuple):
    """The functions that compile a part, or load it.

    Args:
        whole: Compiles all of it.
        pieces: Compile most of it, and share little, so that processes do it side by side.
        seconds: About how many seconds of a processor it takes.
    """

    whole: Compile
    pieces: Sequence[Compile]
    seconds: int


def _maps() -> None:
    """Compile what maps need, and import what their survey does."""
    detours.warm_up()
    import_module("scipy.ndimage")


WORK: Mapping[Part, Compilation] = {
    Part.FEW_CITIES: Compilation(search.few_cities, (search.two_opt, search.beside_two_opt), 12),
    Part.FEWEST_CITIES: Compilation(search.fewest_cities, (search.fewest_cities,), 1),
    Part.MORE_CITIES: Compilation(
        search.more_cities, (search.three_opt, search.beside_three_opt), 13
    ),
    Part.MAPS: Compilation(_maps, (detours.warm_up,), 2),
    Part.CHANGES: Compilation(insertion.warm_up, (insertion.warm_up,), 1),
    Part.FLEETS: Compilation(fleet.warm_up, (fleet.warm_up,), 11),
    Part.SEVERAL_OBJECTIVES: Compilation(
        search.several_objectives, (search.several_objectives,), 4
    ),
    Part.OVER_THE_DAY: Compilation(day.warm_up, (day.warm_up,), 8),
    Part.FLEETS_OVER_THE_DAY: Compilation(
        fleet.warm_up_over_the_day, (fleet.warm_up_over_the_day,), 11
    ),
    Part.MANY_CITIES: Compilation(search.many_cities, (search.many_cities,), 5),
    Part.BOUNDS: Compilation(search.bounds, (search.bounds,), 4),
}
PIECES = [(part, piece) for part, work in WORK.items() for piece in work.pieces]
