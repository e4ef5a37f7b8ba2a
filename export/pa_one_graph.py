"""The ONNX graph of PA-One for coordinates or for matrices: its text, filled in."""

from typing import NamedTuple

from export.pa_one_names import MATRICES, Names
from export.pa_one_text import BLOCKS, GRAPH, JOINING, PRICES, REJOINING
from models.networks.joining.shortlists import Sizes
from models.rollout_repairs import Cut

_TYPES = {
    "ends": "int64[r, {e}]",
    "partners": "int64[r, {e}]",
    "open": "bool[r, {e}]",
    "links": "int64[r, l]",
    "left": "int64[r]",
    "leans": "float[r, {e}]",
    "kept": "int64[1]",
}
_BY_END = ("ends", "partners", "open", "leans")  # from which the kept ends are sliced


class GraphSizes(NamedTuple):
    """The numbers in the text of the graph.

    Args:
        room: Entries of lists and of costs in a block.
        lists: Of the shortlists.
        many: The number of cities above which a round has more joinings.
        early: The most cities that a repair looks at, and that it cuts out.
        late: The same of late repairs.
        late_from: The number of repairs after which they are late.
    """

    room: int
    lists: Sizes
    many: int
    early: Cut
    late: Cut
    late_from: int


def graph(names: Names, opset: int, sizes: GraphSizes) -> str:
    """Return the text of the graph."""
    by_row = ("weights", *names.prices)
    is_matrices = names is MATRICES
    return GRAPH.substitute(
        opset=opset,
        room=sizes.room,
        length=sizes.lists.length,
        short=sizes.lists.short,
        few=sizes.lists.ends,
        share=sizes.lists.share,
        many=sizes.many,
        near=sizes.early.near,
        cut=sizes.early.cities,
        late_near=sizes.late.near,
        late_cut=sizes.late.cities,
        late_from=sizes.late_from,
        given=names.instance,
        instance="float[m, n, n]" if is_matrices else "float[n, x]",
        cities_axis="start = 1, end = 2" if is_matrices else "start = 0, end = 1",
        prepared=_listed((*names.tables, "weights")),
        prices=_prices(names) if is_matrices else "",
        knots=sizes.lists.knots,
        no_lists=_listed(("no_cities",) + ("no_costs",) * (len(names.lists) - 1)),
        lists=_listed(names.lists),
        lists_so_far=_types_of_lists(names.lists, "so_far_", "[g, done, l]"),
        more_lists=_types_of_lists(names.lists, "longer_", "[g, grown, l]"),
        new_lists=_listed(names.lists, "new_"),
        tables_and_known=_listed((*names.tables, *names.known)),
        lists_appended=_appended(names.lists, axis=1),
        blocks_of_rows=BLOCKS.substitute(times="blocks", size="size", entries="entries", count="k"),
        blocks_of_cities=BLOCKS.substitute(
            times="times", size="at_a_time", entries="costs_of_a_city", count="n"
        ),
        problem=_listed(names.problem),
        tables=_listed(names.tables),
        rows_of_block="\n".join(
            f"block_{name} = Slice ({name}, first_row, beyond_row, zero)" for name in by_row
        ),
        joining=_joining(names),
        between=_listed(names.costs, "between_"),
        given_to_rejoin=_listed((*names.fragments, "kept"), "given_"),
        slices_of_given=_slices(names.fragments, "given_", "given_some_"),
        sliced_given=_listed(names.fragments, "given_some_"),
        after_cut=_listed((*names.fragments, "kept"), "cut_"),
        rejoining=_rejoining(names, "Rejoin", "is_cut", ("cut_", "new_"), "between_"),
        new_fragments=_listed(names.fragments, "new_"),
    )


def _types_of_lists(names: tuple[str, ...], prefix: str, shape: str) -> str:
    kinds = ("int64", *("float",) * (len(names) - 1))
    return ", ".join(
        f"{kind}{shape} {prefix}{name}" for kind, name in zip(kinds, names, strict=True)
    )


def _appended(names: tuple[str, ...], axis: int) -> str:
    """Return the lines that append new tensors to those that a loop has so far."""
    return "\n".join(
        f"longer_{name} = Concat <axis = {axis}> (so_far_{name}, new_{name})" for name in names
    )


def _prices(names: Names) -> str:
    """Return the lines that find the prices of all rows, and those that are known at the knots."""

    def typed(given: tuple[str, ...], prefix: str, shape: str) -> str:
        return ", ".join(f"float{shape} {prefix}{name}" for name in given)

    return PRICES.substitute(
        prices=_listed(names.prices),
        known=_listed(names.known),
        tables=_listed(names.tables),
        flat_prices=typed(names.prices, "flat_", "[k, n]"),
        flat_known=typed(names.known, "flat_", "[g, n]"),
        names_flat_prices=_listed(names.prices, "flat_"),
        names_flat_known=_listed(names.known, "flat_"),
        own_prices=typed(names.prices, "own_", "[k, n]"),
        no_known=typed(names.known, "no_", "[g, n]"),
        names_own_prices=_listed(names.prices, "own_"),
        names_no_known="\n".join(
            f"no_{name} = Identity (no_rows_of_prices)" for name in names.known
        ),
        blocks_of_priced_rows=BLOCKS.substitute(
            times="priced_times", size="priced_at_a_time", entries="pairs_of_cities", count="k"
        ),
        no_prices=_listed(("no_rows_of_prices",) * len(names.prices)),
        prices_so_far=typed(names.prices, "so_far_", "[done, n]"),
        more_prices=typed(names.prices, "longer_", "[grown, n]"),
        new_prices=_listed(names.prices, "new_"),
        prices_appended=_appended(names.prices, axis=0),
    )


def _joining(names: Names) -> str:
    """Return the lines that build the tours of a block."""
    kept = (*names.fragments, "kept")
    return JOINING.substitute(
        problem_of_block=_listed(
            (*names.tables, *(f"block_{name}" for name in ("weights", *names.prices)))
        ),
        costs=_listed(names.costs),
        lists=_listed(names.lists),
        row_lists=_listed(names.row_lists),
        flat_row_lists=_types_of_lists(names.row_lists, "flat_", "[r, n, l]"),
        names_flat_row_lists=_listed(names.row_lists, "flat_"),
        own_row_lists=_types_of_lists(names.row_lists, "own_", "[r, n, l]"),
        names_own_row_lists=_listed(names.row_lists, "own_"),
        blocks_of_cities_in_block=BLOCKS.substitute(
            times="own_times",
            size="own_at_a_time",
            entries="costs_of_a_city_in_block",
            count="n",
        ),
        no_row_lists=_listed(
            ("no_cities_of_rows",) + ("no_costs_of_rows",) * (len(names.row_lists) - 1)
        ),
        row_lists_so_far=_types_of_lists(names.row_lists, "so_far_", "[r, done, l]"),
        more_row_lists=_types_of_lists(names.row_lists, "longer_", "[r, grown, l]"),
        new_row_lists=_listed(names.row_lists, "new_"),
        row_lists_appended=_appended(names.row_lists, axis=1),
        begun=_listed(kept),
        last=_listed(kept, "last_"),
        given_to_join=_typed(kept, "all_", "e"),
        joined=_typed(kept, "out_", "f"),
        many_joined=_typed(kept, "many_", "f"),
        names_many_joined=_listed(kept, "many_"),
        few_joined=_typed(kept, "few_joined_", "f"),
        names_few_joined=_listed(kept, "few_joined_"),
        slices=_slices(names.fragments, "all_", "in_"),
        sliced=_listed(names.fragments, "in_"),
        names_joined=_listed(kept, "out_"),
        slices_of_last=_slices(names.fragments, "last_", "whole_"),
        sliced_last=_listed(names.fragments, "whole_"),
        few=_listed(kept, "few_"),
        rejoining_of_few=_rejoining(names, "JoinFew", "is_open", ("few_", "solved_"), ""),
        solved=_listed(names.fragments, "solved_"),
    )


def _rejoining(
    names: Names, part: str, unfinished: str, prefixes: tuple[str, str], costs: str
) -> str:
    """Return the lines that join fragments by a part; prefixes are of names before and after."""
    kept = (*names.fragments, "kept")
    before, after = prefixes
    return REJOINING.substitute(
        prefix=before,
        join=part,
        unfinished=unfinished,
        before=_listed(kept, before),
        after=_listed(kept, after),
        costs=_listed(names.costs, costs),
        given=_typed(kept, f"{before}in_", "e"),
        rejoined=_typed(kept, f"{before}out_", "f"),
        slices=_slices(names.fragments, f"{before}in_", f"{before}some_"),
        sliced=_listed(names.fragments, f"{before}some_"),
        names=_listed(kept, f"{before}out_"),
    )


def _listed(names: tuple[str, ...], prefix: str = "") -> str:
    return ", ".join(prefix + name for name in names)


def _typed(names: tuple[str, ...], prefix: str, ends: str) -> str:
    return ", ".join(f"{_TYPES[name].format(e=ends)} {prefix}{name}" for name in names)


def _slices(names: tuple[str, ...], all_: str, prefix: str) -> str:
    """Return lines that keep the first ends, and pass on the tensors that have no axis of ends."""
    return "\n".join(
        f"{prefix}{name} = Slice ({all_}{name}, zero, {all_}kept, one)"
        if name in _BY_END
        else f"{prefix}{name} = Identity ({all_}{name})"
        for name in names
    )
