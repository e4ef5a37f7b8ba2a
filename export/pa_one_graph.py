"""The ONNX graph of PA-One as text, with its loops, and the names of what its parts pass on.

A block has as many preferences as there is room for their costs. It begins with a round of all
cities; further rounds work on the ends that are still open, of which there are fewer each time. A
loop goes along the links of the finished tours. When all tours are there, a last loop repairs
them. The functions of the domain `paretour` are the parts that `export.pa_one` puts in.
"""

GRAPH = """
<ir_version: 10, opset_import: ["": %(opset)d, "paretour": 1]>
actor (float[n, 4] cities, float[k, 2] preferences, int64 repairs)
    => (int64[k, n] tours, int64[k, n] visited)
{
    zero = Constant <value_ints = [0]> ()
    one = Constant <value_ints = [1]> ()
    two = Constant <value_ints = [2]> ()
    room = Constant <value_ints = [%(room)d]> ()
    n = Shape <start = 0, end = 1> (cities)
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
    distances, weights = paretour.Prepare (cities, preferences)

    least_of_nothing = CastLike (nothing, distances)
    built, least = Loop (blocks, , nothing, least_of_nothing) <body = add_block
        (int64 block, bool before, int64[done, n] so_far, float[done, n] least_so_far)
        => (bool after, int64[grown, n] longer, float[grown, n] least_longer)
        {
            after = Identity (before)
            first_row = Mul (block, size)
            beyond_row = Add (first_row, size)
            rows = Slice (weights, first_row, beyond_row, zero)
            costs, least_edges, ends, partners, open, links, left, kept, unfinished =
                paretour.Begin (distances, rows)

            last_ends, last_partners, last_open, last_links, last_left, last_kept = Loop
                (cities_in_all, unfinished, ends, partners, open, links, left, kept) <body = join
                (int64 round, bool going_on, int64[r, e] all_ends, int64[r, e] all_partners,
                 bool[r, e] all_open, int64[r, l] links_in, int64[r] left_in, int64[1] kept_in)
                => (bool go_on, int64[r, f] ends_out, int64[r, f] partners_out,
                    bool[r, f] open_out, int64[r, l] links_out, int64[r] left_out,
                    int64[1] kept_out)
                {
                    ends_in = Slice (all_ends, zero, kept_in, one)
                    partners_in = Slice (all_partners, zero, kept_in, one)
                    open_in = Slice (all_open, zero, kept_in, one)
                    ends_out, partners_out, open_out, links_out, left_out, kept_out, go_on =
                        paretour.Round (costs, ends_in, partners_in, open_in, links_in, left_in)
                }>

            first, second = paretour.Start
                (last_ends, last_partners, last_open, last_links, last_left)
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

    most_cut = Constant <value_ints = [%(cities_cut)d]> ()
    to_cut = Min (most_cut, n)
    count = ConstantOfShape (to_cut)
    built_points, built_freshness = paretour.Unrepaired (distances, built)
    tours, points, visited, visited_points, freshness = Loop
        (repairs, , built, built_points, built, built_points, built_freshness) <body = repair
        (int64 number, bool repairing, int64[k, n] tours_in, float[k, 2] points_in,
         int64[k, n] visited_in, float[k, 2] visited_points_in, float[k, n] freshness_in)
        => (bool repair_on, int64[k, n] tours_out, float[k, 2] points_out,
            int64[k, n] visited_out, float[k, 2] visited_points_out, float[k, n] freshness_out)
        {
            repair_on = Identity (repairing)
            cut_cities, turned, places, gaps, between, cut_ends, cut_partners, cut_open,
                cut_links, cut_left, cut_kept, is_cut = paretour.Cut
                (distances, weights, least, tours_in, freshness_in, count)
            new_ends, new_partners, new_open, new_links, new_left, new_kept = Loop
                (cities_in_all, is_cut, cut_ends, cut_partners, cut_open, cut_links, cut_left,
                 cut_kept) <body = rejoin
                (int64 round, bool parted, int64[r, e] some_ends, int64[r, e] some_partners,
                 bool[r, e] some_open, int64[r, l] some_links, int64[r] some_left,
                 int64[1] some_kept)
                => (bool apart, int64[r, f] joined_ends, int64[r, f] joined_partners,
                    bool[r, f] joined_open, int64[r, l] joined_links, int64[r] joined_left,
                    int64[1] joined_kept)
                {
                    open_ends = Slice (some_ends, zero, some_kept, one)
                    open_partners = Slice (some_partners, zero, some_kept, one)
                    open_open = Slice (some_open, zero, some_kept, one)
                    joined_ends, joined_partners, joined_open, joined_links, joined_left,
                        joined_kept, apart = paretour.Rejoin (between, open_ends, open_partners,
                        open_open, some_links, some_left)
                }>
            tours_out, points_out, visited_out, visited_points_out, freshness_out = paretour.Keep
                (distances, weights, tours_in, points_in, visited_in, visited_points_in,
                 freshness_in, cut_cities, turned, places, gaps, between, new_ends, new_partners,
                 new_open, new_links, new_left)
        }>
}
"""

FRAGMENTS = ("ends", "partners", "open", "links", "left")
AFTER_ROUND = tuple(f"new_{name}" for name in (*FRAGMENTS, "kept", "go_on"))
CUTS = ("turned", "places", "gaps")
STATE = ("tours", "points", "visited", "visited_points", "freshness")
