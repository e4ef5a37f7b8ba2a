"""`python -m tests.benchmarks ablation`: what the search gains from the tours it sets out from.

On the paper's instances, at equal total time, building the first tours included: from the
network's tours for 100 and for 10 preferences, from those of greedy edge for 17 weights, from
100 random tours, and from nothing, when the search builds its own by nearest neighbour. And from
the network's tours for 100 preferences where, as far as there are enough, the cities that these
join to a city are its candidates, and not those nearest to it. One thread. Prints a table and
stores `results/ablation.json`; with `--only`, beside what is stored of the same network.
"""

import argparse
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import partial
from typing import Any
from unittest import mock

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from service.actor import OnnxActor
from service.front import SearchResult
from service.instance import Instance, tour_lengths
from service.pareto import hypervolume
from service.preferences import fan, from_angles
from service.search.candidates import CANDIDATES_PER_CITY, make_candidate_pool
from service.search.costs import tabulate
from service.search.improve import improve
from service.search.schedule import Search
from service.search.warm_up import warm_up
from service.watch import Watch
from tests.benchmarks.actors import ACTORS
from tests.benchmarks.instances import paper_instances, reference_points
from tests.benchmarks.provenance import load, provenance, store
from tests.benchmarks.rivals.construction import greedy_edge, spread_weights

SECONDS = {40: (0.02, 0.05, 0.2), 200: (0.1, 0.3, 1.0), 500: (0.5, 1.0, 3.0), 1000: (2.0, 5.0)}

EDGES = "100 tours of the network, and their edges"
Build = Callable[[Instance], NDArray[np.integer]]
Candidates = Callable[[NDArray[np.integer]], AbstractContextManager[None]]


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks ablation", description=__doc__)
    parser.add_argument("--actor", default="pa-one")
    parser.add_argument("--count", type=int, default=10, help="instances of each size")
    parser.add_argument("--only", nargs="+", metavar="COLUMN", help="columns; default: all")
    options = parser.parse_args(arguments)
    actor = OnnxActor(ACTORS / f"{options.actor}.onnx", threads=1)
    actor.load()
    builders = _builders(actor)
    warm_up()
    stored = load("ablation")
    known = stored["rows"] if stored.get("digest") == actor.info.digest else {}
    facts = {"digest": actor.info.digest, "instances": options.count}
    results: dict[str, Any] = {**provenance(1), **facts, "rows": known}
    for n, limits in SECONDS.items():
        instances = [Instance(coordinates=x) for x in paper_instances(n, options.count)]
        for limit in limits:
            row = results["rows"].setdefault(f"{n} cities, {limit} s", {})
            for name in options.only or builders:
                candidates = edges_as_candidates if name == EDGES else nullcontext
                row[name] = _mean(builders[name], instances, limit, candidates)
            store("ablation", results)
    _print_table(results["rows"])


def _builders(actor: OnnxActor) -> dict[str, Build]:
    def network(k: int, instance: Instance) -> NDArray[np.integer]:
        return actor.tours(instance, from_angles(fan(k)))

    def at_random(instance: Instance) -> NDArray[np.integer]:
        generator = np.random.default_rng(0)
        return np.stack([generator.permutation(instance.n) for _ in range(100)])

    return {
        "nothing": lambda instance: np.empty((0, instance.n), np.int64),
        "100 tours of the network": partial(network, 100),
        EDGES: partial(network, 100),
        "10 tours of the network": partial(network, 10),
        "17 tours of greedy edge": lambda instance: greedy_edge(instance, spread_weights(17)),
        "100 random tours": at_random,
    }


def _mean(
    build: Build, instances: list[Instance], limit: float, candidates: Candidates
) -> dict[str, float]:
    """Mean hypervolume in per cent, mean seconds, and how many builds alone took too long."""
    build(instances[0])  # compiles, and fills caches
    shares, seconds, late = [], [], 0
    for instance in tqdm(instances, desc=f"{instances[0].n} cities, {limit} s", leave=False):
        watch = Watch[SearchResult](limit)
        tours = build(instance)
        late += watch.over()
        with candidates(tours):
            found = improve(instance, tours, watch=watch)
        seconds.append(watch.spent)
        [reference_point, *_] = reference_points(instance.n).values()
        shares.append(100 * hypervolume(tour_lengths(instance, found.tours), reference_point))
    return {
        "hypervolume": round(float(np.mean(shares)), 3),
        "seconds": round(float(np.mean(seconds)), 3),
        "late": late,
    }


@contextmanager
def edges_as_candidates(tours: NDArray[np.integer]) -> Iterator[None]:
    """Searches take for a city's candidates those that the tours join it to, most often first.

    A city with too few gets others that cost little under equal weights.
    """
    n = tours.shape[1]
    joined = np.zeros((n, n))
    for there in (np.roll(tours, -1, axis=1), np.roll(tours, 1, axis=1)):
        np.add.at(joined, (tours.ravel(), there.ravel()), 1.0)

    def pooled(search: Search) -> Iterator[int]:
        search.pool = make_candidate_pool(n)
        cities, costs, sizes = search.pool
        width = cities.shape[1]
        steps = np.empty((n, n, 2))
        tabulate(search.state.costs.cities, steps)
        equal = steps @ search.weights[search.middle]
        np.fill_diagonal(equal, 2 * equal.max() + 1)
        ranked = equal - 2 * equal.max() * joined
        first = ranked.argpartition(width - 1, axis=1)[:, :width]
        by_rank = np.take_along_axis(ranked, first, axis=1).argsort(axis=1)
        cities[:] = np.take_along_axis(first, by_rank, axis=1)
        costs[:] = steps[np.arange(n)[:, np.newaxis], cities]
        sizes[:] = np.clip((joined > 0).sum(axis=1), min(CANDIDATES_PER_CITY, n - 1), width)
        yield 0

    with mock.patch.object(Search, "pool_candidates", pooled):
        yield


def _print_table(rows: dict[str, dict[str, dict[str, float]]]) -> None:
    names = list(next(iter(rows.values())))
    print("| hypervolume, %, at (n, n), searching from | " + " | ".join(names) + " |")
    print("|---" * (len(names) + 1) + "|")
    for title, row in rows.items():
        cells = [
            f"{row[name]['hypervolume']:.2f}" + (" (late)" if row[name]["late"] else "")
            for name in names
        ]
        print(f"| {title} | " + " | ".join(cells) + " |")
