"""The text of PA-One's ONNX graph, with its loops, to be filled in.

A block has as many preferences as there is room for their lists, and for the costs between the
ends of a contracted problem. It begins with a round of all cities; further rounds work on the ends
that are still open, fewer each time. A loop of a few passes finds the place of each city on its
tour. When all tours are built, a last loop repairs them. The functions of the
domain `paretour` are the parts that `export.pa_one` puts in.

There is one text for coordinates and for matrices. Where costs have directions, the tables of
costs, the shortlists and the fragments also have tensors of leans, and there are prices; a block
takes the prices of its rows.

Under two objectives shortlists are made once, for intervals of weights, and so are prices. Under
more each row has its own.
"""

from string import Template

GRAPH = Template("""
<ir_version: 10, opset_import: ["": $opset, "paretour": 1]>
actor ($instance $given, float[k, m] preferences, int64 repairs)
    => (int64[k, n] tours, int64[k, n] visited)
{
    zero = Constant <value_ints = [0]> ()
    one = Constant <value_ints = [1]> ()
    nought = Constant <value_int = 0> ()
    unit = Constant <value_int = 1> ()
    room = Constant <value_ints = [$room]> ()
    n = Shape <$cities_axis> ($given)
    k = Shape <start = 0, end = 1> (preferences)
    cities_in_all = Squeeze (n)
    long = Constant <value_ints = [$length]> ()
    short = Constant <value_ints = [$short]> ()
    few = Constant <value_ints = [$few]> ()
    share = Constant <value_ints = [$share]> ()
    are_many = Greater (n, few)
    many = Constant <value_ints = [$many]> ()
    exceeds_many = Greater (n, many)
    are_many_to_join = Squeeze (exceeds_many)
    length = Where (are_many, long, short)
    on_a_list = ConstantOfShape (length)
    listed = Mul (n, length)
    most_few = Min (n, few)
    share_of_all = Div (n, share)
    ends_in_all = Max (most_few, share_of_all)
    pairs = Mul (ends_in_all, ends_in_all)
    entries = Add (listed, pairs)
    $blocks_of_rows
    shape_of_nothing = Concat <axis = 0> (zero, n)
    nothing = ConstantOfShape <value = int64[1] {0}> (shape_of_nothing)
    m = Shape <start = 1, end = 2> (preferences)
    two = Constant <value_ints = [2]> ()
    are_two = Equal (m, two)
    is_flat = Squeeze (are_two)
    aimed = If (is_flat) <
        then_branch = flat () => (float[k, m] turned_preferences)
        {
            turned_preferences = paretour.Turn (preferences)
        },
        else_branch = round () => (float[k, m] same_preferences)
        {
            same_preferences = Identity (preferences)
        }>
    $prepared = paretour.Prepare ($given, aimed)
    $prices
    all_cities = Range (nought, cities_in_all, unit)
    knots = Constant <value_ints = [$knots]> ()
    costs_of_a_city = Mul (n, knots)
    $blocks_of_cities
    intervals = Sub (knots, one)
    shape_of_no_lists = Concat <axis = 0> (intervals, zero, length)
    no_cities = ConstantOfShape <value = int64[1] {0}> (shape_of_no_lists)
    no_costs = ConstantOfShape <value = float[1] {0}> (shape_of_no_lists)
    no_times = Constant <value_int = 0> ()
    times_if_flat = Where (is_flat, times, no_times)
    $lists = Loop (times_if_flat, , $no_lists) <body = add_lists
        (int64 time, bool before_lists, $lists_so_far) => (bool after_lists, $more_lists)
        {
            after_lists = Identity (before_lists)
            first_city = Mul (time, at_a_time)
            beyond_city = Add (first_city, at_a_time)
            some_cities = Slice (all_cities, first_city, beyond_city, zero)
            $new_lists = paretour.List ($tables_and_known, some_cities, on_a_list)
            $lists_appended
        }>

    least_of_nothing = CastLike (nothing, weights)
    built, least = Loop (blocks, , nothing, least_of_nothing) <body = add_block
        (int64 block, bool before, int64[done, n] so_far, float[done, n] least_so_far)
        => (bool after, int64[grown, n] longer, float[grown, n] least_longer)
        {
            after = Identity (before)
            first_row = Mul (block, size)
            beyond_row = Add (first_row, size)
            $rows_of_block
            $joining
            seen, steps_to_there = Loop (cities_in_all, is_unseen, onwards, ahead) <body = walk
                (int64 pass, bool walking_on, int64[r, d] departures_seen, int64[r, d] steps_seen)
                => (bool walk_on, int64[r, d] seen_further, int64[r, d] steps_further)
                {
                    seen_further, steps_further, walk_on = paretour.Double
                        (departures_seen, steps_seen, begin, last_departure)
                }>
            found = paretour.Walk (seen, steps_to_there, begin, last_departure)
            longer = Concat <axis = 0> (so_far, found)
            least_longer = Concat <axis = 0> (least_so_far, least_edges)
        }>

    late_from = Constant <value_int = $late_from> ()
    early_near = Constant <value_ints = [$near]> ()
    early_cut = Constant <value_ints = [$cut]> ()
    late_near = Constant <value_ints = [$late_near]> ()
    late_cut = Constant <value_ints = [$late_cut]> ()
    built_points, built_freshness = paretour.Unrepaired ($tables, built)
    tours, points, visited, visited_points, freshness = Loop
        (repairs, , built, built_points, built, built_points, built_freshness) <body = repair
        (int64 number, bool repairing, int64[k, n] tours_in, float[k, m] points_in,
         int64[k, n] visited_in, float[k, m] visited_points_in, float[k, n] freshness_in)
        => (bool repair_on, int64[k, n] tours_out, float[k, m] points_out,
            int64[k, n] visited_out, float[k, m] visited_points_out, float[k, n] freshness_out)
        {
            repair_on = Identity (repairing)
            is_late = GreaterOrEqual (number, late_from)
            most_near = Where (is_late, late_near, early_near)
            most_cut = Where (is_late, late_cut, early_cut)
            to_look_at = Min (most_near, n)
            to_cut = Min (most_cut, n)
            near = ConstantOfShape (to_look_at)
            count = ConstantOfShape (to_cut)
            cut_cities, turned, places, gaps, $between, $given_to_rejoin, is_given = paretour.Cut
                ($problem, least, tours_in, points_in, freshness_in, number, near, count)
            $slices_of_given
            $after_cut, is_cut = paretour.RejoinFirst ($between, $sliced_given)
            $rejoining
            tours_out, points_out, visited_out, visited_points_out, freshness_out = paretour.Keep
                ($tables, weights, tours_in, points_in, visited_in, visited_points_in,
                 freshness_in, cut_cities, turned, places, gaps, $between, $new_fragments)
        }>
}
""")

# Of cities, with candidates from lists while many ends are open; then the problem is contracted.
JOINING = Template("""
            $row_lists = If (is_flat) <
                then_branch = of_intervals () => ($flat_row_lists)
                {
                    $names_flat_row_lists = paretour.ListRows (block_weights, $lists)
                },
                else_branch = of_rows () => ($own_row_lists)
                {
                    rows_of_block = Shape <start = 0, end = 1> (block_weights)
                    costs_of_a_city_in_block = Mul (n, rows_of_block)
                    $blocks_of_cities_in_block
                    shape_of_no_rows = Concat <axis = 0> (rows_of_block, zero, length)
                    no_cities_of_rows = ConstantOfShape <value = int64[1] {0}> (shape_of_no_rows)
                    no_costs_of_rows = ConstantOfShape <value = float[1] {0}> (shape_of_no_rows)
                    $names_own_row_lists = Loop (own_times, , $no_row_lists) <body = add_row_lists
                        (int64 own_time, bool before_own, $row_lists_so_far)
                        => (bool after_own, $more_row_lists)
                        {
                            after_own = Identity (before_own)
                            own_first = Mul (own_time, own_at_a_time)
                            own_beyond = Add (own_first, own_at_a_time)
                            own_cities = Slice (all_cities, own_first, own_beyond, zero)
                            $new_row_lists = paretour.OwnLists
                                ($problem_of_block, own_cities, on_a_list)
                            $row_lists_appended
                        }>
                }>
            least_edges, $begun, unfinished = paretour.Begin ($problem_of_block, $row_lists)
            $last = Loop (cities_in_all, unfinished, $begun) <body = join
                (int64 round, bool going_on, $given_to_join)
                => (bool go_on, $joined)
                {
                    $slices
                    $names_joined, go_on = If (are_many_to_join) <
                        then_branch = many_joined () => ($many_joined, bool go_on_with_many)
                        {
                            $names_many_joined, go_on_with_many = paretour.RoundOfMany
                                ($problem_of_block, $row_lists, $sliced)
                        },
                        else_branch = few_joined () => ($few_joined, bool go_on_with_few)
                        {
                            $names_few_joined, go_on_with_few = paretour.Round
                                ($problem_of_block, $row_lists, $sliced)
                        }>
                }>
            $slices_of_last
            $costs, $few, is_open = paretour.Contract ($problem_of_block, $sliced_last)
            $rejoining_of_few
            onwards, ahead, begin, last_departure, is_unseen = paretour.Finish
                ($problem_of_block, $sliced_last, $costs, $solved)
""")

# Of rows that share those of the knots, or have their own.
PRICES = Template("""
    $prices, $known = If (is_flat) <
        then_branch = of_knots () => ($flat_prices, $flat_known)
        {
            $names_flat_known = paretour.Know ($tables)
            $names_flat_prices = paretour.Price (weights, $names_flat_known)
        },
        else_branch = of_each_row () => ($own_prices, $no_known)
        {
            pairs_of_cities = Mul (n, n)
            $blocks_of_priced_rows
            no_rows_of_prices = ConstantOfShape <value = float[1] {0}> (shape_of_nothing)
            $names_no_known
            $names_own_prices = Loop (priced_times, , $no_prices) <body = add_prices
                (int64 priced_time, bool before_prices, $prices_so_far)
                => (bool after_prices, $more_prices)
                {
                    after_prices = Identity (before_prices)
                    priced_first = Mul (priced_time, priced_at_a_time)
                    priced_beyond = Add (priced_first, priced_at_a_time)
                    priced_weights = Slice (weights, priced_first, priced_beyond, zero)
                    $new_prices = paretour.OwnPrices ($tables, priced_weights)
                    $prices_appended
                }>
        }>
""")

# Of a few fragments, until two are left at most.
REJOINING = Template("""
            $after = Loop (cities_in_all, $unfinished, $before) <body = rejoin
                (int64 ${prefix}round, bool ${prefix}going_on, $given)
                => (bool ${prefix}go_on, $rejoined)
                {
                    $slices
                    $names, ${prefix}go_on = paretour.$join ($costs, $sliced)
                }>
""")

# Blocks of rows or of cities: as many at a time as their entries have room, one at least.
BLOCKS = Template("""
    ${times}_fitting = Div (room, $entries)
    ${times}_at_least = Max (${times}_fitting, one)
    $size = Min (${times}_at_least, $count)
    ${times}_with_last = Add ($count, $size)
    ${times}_filled = Sub (${times}_with_last, one)
    ${times}_in_all = Div (${times}_filled, $size)
    $times = Squeeze (${times}_in_all)
""")
