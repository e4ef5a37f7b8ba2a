"""Cut tours: the circuits that segments make, and the tour where they make one."""

import numpy as np

from service.search.edge_assembly.cut_tour import (
    CutTour,
    lay_out,
    make_cut_tour,
    trace_circuits,
)
from service.search.edge_assembly.cut_tour import (
    add_cut as add_cut_kernel,
)
from service.search.edge_assembly.cut_tour import (
    link as link_kernel,
)
from service.search.edge_assembly.cut_tour import (
    segment_at as segment_at_kernel,
)
from tests.helpers.kernels import for_python

add_cut = for_python(add_cut_kernel)
link = for_python(link_kernel)
segment_at = for_python(segment_at_kernel)

N = 11


def cut_at_random(seed: int) -> CutTour:
    """A random tour, cut at random steps, whose ends have mates at random."""
    rng = np.random.default_rng(seed)
    tour = rng.permutation(N).astype(np.int32)
    cut = make_cut_tour(tour, np.argsort(tour).astype(np.int32))
    places = rng.permutation(N)[: rng.integers(2, 7)]
    for place in places.tolist():
        add_cut(cut, place)
    ends = rng.permutation(2 * len(places)).tolist()
    for one, other in zip(ends[::2], ends[1::2], strict=True):
        link(cut, one, other)
    return cut


def steps(cut: CutTour) -> list[tuple[int, int]]:
    """The steps within segments, and those to mates."""
    count = int(cut.counts[0])
    cuts, tour = set(cut.places[:count].tolist()), cut.tour.tolist()
    kept = [(tour[k], tour[(k + 1) % N]) for k in range(N) if k not in cuts]
    at = [tour[(int(cut.places[end // 2]) + end % 2) % N] for end in range(2 * count)]
    mates = cut.mates.tolist()
    return kept + [(at[end], at[mates[end]]) for end in range(2 * count) if end < mates[end]]


def circuit_sizes(cut: CutTour) -> list[int]:
    """The numbers of cities that hang together by steps, in order."""
    parts = {city: {city} for city in range(N)}
    for one, other in steps(cut):
        whole = parts[one] | parts[other]
        for city in whole:
            parts[city] = whole
    return sorted(len(part) for part in {frozenset(part) for part in parts.values()})


def test_circuits_are_the_cities_that_hang_together() -> None:
    for seed in range(200):
        cut = cut_at_random(seed)
        expected = circuit_sizes(cut)
        trace_circuits(cut)
        assert sorted(cut.sizes[: cut.counts[1]].tolist()) == expected


def test_the_segment_at_a_place_begins_behind_the_cut_before_it() -> None:
    for seed in range(50):
        cut = cut_at_random(seed)
        places = cut.places[: cut.counts[0]]
        for place in range(N):
            back = (place - 1 - places) % N
            assert segment_at(cut, place) == back.argmin()


def test_a_tour_that_is_laid_out_has_the_steps_of_segments_and_mates() -> None:
    whole = 0
    for seed in range(300):
        cut = cut_at_random(seed)
        expected = sorted(sorted(step) for step in steps(cut))
        trace_circuits(cut)
        if cut.counts[1] > 1:
            continue
        whole += 1
        lay_out(cut)
        tour = cut.tour.tolist()
        assert sorted(tour) == list(range(N))
        assert cut.tour[cut.position].tolist() == list(range(N))
        after = zip(tour, tour[1:] + tour[:1], strict=True)
        assert sorted(sorted(step) for step in after) == expected
    assert whole > 50
