"""The names of the tensors that the parts of PA-One's ONNX graph pass on to each other."""

from typing import NamedTuple

CUTS = ("turned", "places", "gaps")
STATE = ("tours", "points", "visited", "visited_points", "freshness")


class Names(NamedTuple):
    """The names of the tensors that parts pass on, for coordinates or for matrices."""

    instance: str
    tables: tuple[str, ...]
    prices: tuple[str, ...]
    known: tuple[str, ...]
    costs: tuple[str, ...]
    fragments: tuple[str, ...]
    lists: tuple[str, ...]
    row_lists: tuple[str, ...]

    @property
    def problem(self) -> tuple[str, ...]:
        """The tables, the weights of each row, its prices."""
        return *self.tables, "weights", *self.prices

    @property
    def after_round(self) -> list[str]:
        """The fragments, how many ends to keep, and whether more are to be joined."""
        return [f"new_{name}" for name in (*self.fragments, "kept", "go_on")]


_FRAGMENTS = ("ends", "partners", "open", "links", "left")
_LISTS = ("listed_cities", "listed_means", "rise_of_means")
_ROW_LISTS = ("row_cities", "row_means")
COORDINATES = Names("cities", ("planes",), (), (), ("costs",), _FRAGMENTS, _LISTS, _ROW_LISTS)
MATRICES = Names(
    "matrices",
    ("means", "mean_leans"),
    ("fees", "tilts"),
    ("known_fees", "known_tilts"),
    ("costs", "cost_leans"),
    (*_FRAGMENTS, "leans"),
    (*_LISTS, "listed_leans", "rise_of_leans"),
    (*_ROW_LISTS, "row_leans"),
)
