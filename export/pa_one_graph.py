"""The ONNX graph of PA-One as text, with its loops, and the names of what its parts pass on.

A block has as many preferences as there is room for their costs. It begins with a round of all
cities; further rounds work on the ends that are still open, of which there are fewer each time. A
loop goes along the links of the finished tours. When all tours are there, a last loop repairs
them. The functions of the domain `paretour` are the parts that `export.pa_one` puts in.

There is one text for coordinates and for matrices. Where costs have directions, the tables of
costs and the fragments have a tensor of leans more, and there are prices, of which a block takes
its rows.
"""

from string import Template
from typing import NamedTuple

_GRAPH = Template("""
<ir_version: 10, opset_import: ["": $opset, "paretour": 1]>
actor ($instance $given, float[k, 2] preferences, int64 repairs)
    => (int64[k, n] tours, int64[k, n] visited)
{
    zero = Constant <value_ints = [0]> ()
    one = Constant <value_ints = [1]> ()
    two = Constant <value_ints = [2]> ()
    room = Constant <value_ints = [$room]> ()
    n = Shape <$cities_axis> ($given)
    k = Shape <start = 0, end = 1> (preferences)
    cities_in_all = Squeeze (n)
    steps_in_all = Sub (n, two)
    steps = Squeeze (steps_in_all)
    squared = Mul (n, n)
    fitting = Div (room, squared)
    one_at_least = Max (fitting, one)
    size = Min (one_at_least, k)
    more = Add (k, size)
    filled = Sub (more, one)
    blocks_in_all = Div (filled, size)
    blocks = Squeeze (blocks_in_all)
    shape_of_nothing = Concat <axis = 0> (zero, n)
    nothing = ConstantOfShape <value = int64[1] {0}> (shape_of_nothing)
    $problem = paretour.Prepare ($given, preferences)

    least_of_nothing = CastLike (nothing, weights)
    built, least = Loop (blocks, , nothing, least_of_nothing) <body = add_block
        (int64 block, bool before, int64[done, n] so_far, float[done, n] least_so_far)
        => (bool after, int64[grown, n] longer, float[grown, n] least_longer)
        {
            after = Identity (before)
            first_row = Mul (block, size)
            beyond_row = Add (first_row, size)
            $rows_of_block
            $costs, least_edges, $begun, unfinished = paretour.Begin ($problem_of_block)

            $last = Loop (cities_in_all, unfinished, $begun) <body = join
                (int64 round, bool going_on, $given_to_join)
                => (bool go_on, $joined)
                {
                    $slices
                    $names_joined, go_on = paretour.Round ($costs, $sliced)
                }>

            first, second = paretour.Start ($finished)
            last_before, last_now, others = Loop (steps, , first, second) <body = walk
                (int64 step, bool walking_on, int64[r] city_before, int64[r] city_now)
                => (bool walk_on, int64[r] new_before, int64[r] new_now, int64[r] visited)
                {
                    walk_on = Identity (walking_on)
                    new_before = Identity (city_now)
                    new_now = paretour.Next (last_links, city_before, city_now)
                    visited = Identity (new_now)
                }>
            first_of_all = Unsqueeze (first, zero)
            second_of_all = Unsqueeze (second, zero)
            by_step = Concat <axis = 0> (first_of_all, second_of_all, others)
            found = Transpose <perm = [1, 0]> (by_step)
            longer = Concat <axis = 0> (so_far, found)
            least_longer = Concat <axis = 0> (least_so_far, least_edges)
        }>

    most_cut = Constant <value_ints = [$cities_cut]> ()
    to_cut = Min (most_cut, n)
    count = ConstantOfShape (to_cut)
    built_points, built_freshness = paretour.Unrepaired ($tables, built)
    tours, points, visited, visited_points, freshness = Loop
        (repairs, , built, built_points, built, built_points, built_freshness) <body = repair
        (int64 number, bool repairing, int64[k, n] tours_in, float[k, 2] points_in,
         int64[k, n] visited_in, float[k, 2] visited_points_in, float[k, n] freshness_in)
        => (bool repair_on, int64[k, n] tours_out, float[k, 2] points_out,
            int64[k, n] visited_out, float[k, 2] visited_points_out, float[k, n] freshness_out)
        {
            repair_on = Identity (repairing)
            cut_cities, turned, places, gaps, $between, $cut, is_cut = paretour.Cut
                ($problem, least, tours_in, freshness_in, count)
            $new = Loop (cities_in_all, is_cut, $cut) <body = rejoin
                (int64 round, bool parted, $given_to_rejoin)
                => (bool apart, $rejoined)
                {
                    $slices_rejoined
                    $names_rejoined, apart = paretour.Rejoin ($between, $sliced_rejoined)
                }>
            tours_out, points_out, visited_out, visited_points_out, freshness_out = paretour.Keep
                ($tables, weights, tours_in, points_in, visited_in, visited_points_in,
                 freshness_in, cut_cities, turned, places, gaps, $between, $new_fragments)
        }>
}
""")

CUTS = ("turned", "places", "gaps")
STATE = ("tours", "points", "visited", "visited_points", "freshness")
_TYPES = {
    "ends": "int64[r, {e}]",
    "partners": "int64[r, {e}]",
    "open": "bool[r, {e}]",
    "links": "int64[r, l]",
    "left": "int64[r]",
    "leans": "float[r, {e}]",
    "kept": "int64[1]",
}
_BY_END = ("ends", "partners", "open", "leans")  # of which those that are kept are sliced off


class Names(NamedTuple):
    """The names of what parts pass on, for coordinates or for matrices."""

    instance: str
    tables: tuple[str, ...]
    prices: tuple[str, ...]
    costs: tuple[str, ...]
    fragments: tuple[str, ...]

    @property
    def problem(self) -> tuple[str, ...]:
        """What is found first: the tables, the weights of each row, its prices."""
        return *self.tables, "weights", *self.prices

    @property
    def finished(self) -> tuple[str, ...]:
        """What is needed to begin the tours: fragments, and costs where these have directions."""
        return *(self.costs if self.prices else ()), *self.fragments

    @property
    def after_round(self) -> list[str]:
        """The fragments, how many ends to keep, and whether more are to be joined."""
        return [f"new_{name}" for name in (*self.fragments, "kept", "go_on")]


_FRAGMENTS = ("ends", "partners", "open", "links", "left")
COORDINATES = Names("cities", ("distances",), (), ("costs",), _FRAGMENTS)
MATRICES = Names(
    "matrices",
    ("means", "mean_leans"),
    ("fees", "tilts"),
    ("costs", "cost_leans"),
    (*_FRAGMENTS, "leans"),
)


def graph(names: Names, opset: int, room: int, cities_cut: int) -> str:
    """Return the text of the graph; room is for costs of a block, in entries of one table."""
    kept = (*names.fragments, "kept")
    by_row = ("weights", *names.prices)
    is_matrices = names is MATRICES
    return _GRAPH.substitute(
        opset=opset,
        room=room,
        cities_cut=cities_cut,
        given=names.instance,
        instance="float[2, n, n]" if is_matrices else "float[n, 4]",
        cities_axis="start = 1, end = 2" if is_matrices else "start = 0, end = 1",
        problem=_listed(names.problem),
        tables=_listed(names.tables),
        rows_of_block="\n".join(
            f"block_{name} = Slice ({name}, first_row, beyond_row, zero)" for name in by_row
        ),
        problem_of_block=_listed((*names.tables, *(f"block_{name}" for name in by_row))),
        costs=_listed(names.costs),
        begun=_listed(kept),
        last=_listed(kept, "last_"),
        finished=", ".join(
            name if name in names.costs else f"last_{name}" for name in names.finished
        ),
        given_to_join=_typed(kept, "all_", "e"),
        joined=_typed(kept, "out_", "f"),
        slices=_slices(names.fragments, "all_", "in_"),
        sliced=_listed(names.fragments, "in_"),
        names_joined=_listed(kept, "out_"),
        between=_listed(names.costs, "between_"),
        cut=_listed(kept, "cut_"),
        new=_listed(kept, "new_"),
        new_fragments=_listed(names.fragments, "new_"),
        given_to_rejoin=_typed(kept, "some_", "e"),
        rejoined=_typed(kept, "joined_", "f"),
        slices_rejoined=_slices(names.fragments, "some_", "apart_"),
        sliced_rejoined=_listed(names.fragments, "apart_"),
        names_rejoined=_listed(kept, "joined_"),
    )


def _listed(names: tuple[str, ...], prefix: str = "") -> str:
    return ", ".join(prefix + name for name in names)


def _typed(names: tuple[str, ...], prefix: str, ends: str) -> str:
    return ", ".join(f"{_TYPES[name].format(e=ends)} {prefix}{name}" for name in names)


def _slices(names: tuple[str, ...], all_: str, prefix: str) -> str:
    """Return lines that slice off the ends that are kept, and pass on what is not by end."""
    return "\n".join(
        f"{prefix}{name} = Slice ({all_}{name}, zero, {all_}kept, one)"
        if name in _BY_END
        else f"{prefix}{name} = Identity ({all_}{name})"
        for name in names
    )
