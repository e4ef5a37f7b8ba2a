"""The numbers of cities at which the search changes its ways, without any compiled code."""

MAX_ENUMERATED = 9  # up to which all tours are tried: at most 9!
# From which on iterations use three-opt; at 200 clustered cities it is worse. Where costs differ by
# direction it is better at any number.
THREE_OPT = 250
# From which on costs are not tabulated: two square roots are faster than a look-up that misses the
# second-level cache, and memory stays linear in the number of cities.
DENSE_BELOW = 600
GREEDY = 2_000  # from which on tours are constructed by greedy edge; of 1,000 clustered it is worse
MENDING = 100  # from which on earlier tours are mended by three-opt: too good for two-opt
LARGE = 500  # from which on weights are spaced by their logit; at 400 worse in the first second
VAST = 7_000  # from which on a round of descents alone is first; at 5,000 it gains nothing
