"""`python -m tests.benchmarks day`: fronts over the day, beside planning on mean costs.

Both planes of an instance are uniform, clustered or a made-up city's streets. The first is driven
at 30 km/h through a square of 15 km; or its times are those by road between places in central
Helsinki, as a Valhalla tells them, and the other plane is uniform. A visit takes one to four
minutes, and a tour begins between half past six and eight. Times are 1.8 times as long from 7 to 9
o'clock (one peak), from 16 to 18 as well (two), or only towards the middle in the morning and away
from it in the afternoon (tide). The second objective is the distance in the other plane, the same
all day.

Beside the service's planning of one second: planning on mean costs for one second, its tours driven
through the day in both directions, with their best departures; planning without a day for one
second, its tours driven at the best of a hundred departures; and the service in thirty seconds.
Shares are hypervolumes in the box of all four. Prints a table and stores `results/day.json`.
"""

import argparse
import asyncio
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.data.generators import clustered, streets, uniform
from service.actor import load_actors
from service.day.costs import CostsOfDay
from service.front import PlanOptions
from service.instance import CLOSED, Instance
from service.over_the_day.day import Day
from service.over_the_day.plan import plan_over_the_day
from service.over_the_day.search import DaySearch
from service.over_the_day.warm_up import warm_up
from service.pareto import hypervolume, nondominated
from service.planner import plan
from service.preferences import fan, from_angles
from service.roads.client import RoadClient
from service.roads.router import RouterSettings
from service.watch import Watch
from tests.benchmarks.day_table import PROFILES, SHAPES, SIZES, day_table
from tests.benchmarks.rows import resume
from tests.helpers.helsinki import reachable_places
from tests.helpers.valhalla import valhalla_service

Array = NDArray[np.float64]
Drawn = Callable[[int, np.random.Generator], tuple[Array, Array, Array]]

ACTORS = Path("service/actors")
NETWORK = "pa-one-matrix"
COUNT = 2
BRIEF, LONG = 1.0, 30.0
SIZE = 100
HOUR = 3600.0
SECONDS_ACROSS = 15_000 / (30 / 3.6)
GENERATORS = {"uniform": uniform, "clustered": clustered, "streets": streets}
ROADS = "roads"
BEGINS = np.array([0.0, 7.0, 9.0, 16.0, 18.0]) * HOUR
PEAK = 1.8
DEPARTURES = 100
_ABOVE = 1.02  # times the greatest lengths: the reference point


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks day", description=__doc__)
    parser.add_argument("--stops", dest="sizes", type=int, nargs="+", default=SIZES)
    parser.add_argument("--count", type=int, default=COUNT, help="instances of each kind")
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=SHAPES)
    options = parser.parse_args(arguments)
    warm_up()
    actor = load_actors(ACTORS, threads=1)[NETWORK]
    with tempfile.TemporaryDirectory() as folder, valhalla_service(Path(folder)) as engine:
        drawn: dict[str, Drawn] = {k: partial(_in_planes, v) for k, v in GENERATORS.items()}
        drawn[ROADS] = partial(_by_road, engine.url)
        for n in options.sizes:
            for shape in options.shapes:
                for profile in PROFILES:
                    make = partial(day_of, n, drawn[shape], profile)
                    days = [make(seed) for seed in range(options.count)]
                    measure = partial(measured, actor)
                    measure(make(COUNT), long=BRIEF)  # loads compiled code
                    key = f"{n} stops, {shape}, {profile}"
                    resume("day", key, actor.info.digest, days, measure)
    print(day_table())


def _in_planes(
    generator: Callable[[int, np.random.Generator], Array], n: int, random: np.random.Generator
) -> tuple[Array, Array, Array]:
    """Places in the unit square, the seconds between them, and the distances in another plane."""
    places, others = (generator(n, random) for _ in range(2))
    times, distances = (np.linalg.norm(p[:, np.newaxis] - p, axis=2) for p in (places, others))
    return places, times * SECONDS_ACROSS, distances


def _by_road(url: str, n: int, random: np.random.Generator) -> tuple[Array, Array, Array]:
    """The same of places in central Helsinki, by road; the other plane is uniform."""
    located = asyncio.run(reachable_places(url, n, int(random.integers(2**31))))

    async def ask() -> Array:
        client = RoadClient(RouterSettings(url=url, seconds=120.0))
        try:
            return (await client.costs(located, [str(i) for i in range(n)])).seconds
        finally:
            await client.close()

    corner = located.min(axis=0)
    places = (located - corner) / (located.max(axis=0) - corner)
    _, _, distances = _in_planes(uniform, n, random)
    return places, asyncio.run(ask()), distances


def day_of(n: int, drawn: Drawn, profile: str, seed: int) -> Day:
    """The day of n stops with this number."""
    random = np.random.default_rng([n, seed])
    places, times, distances = drawn(n, random)
    service = random.uniform(60, 240, n)
    service[0] = 0.0
    return Day(
        costs=[_travel(places, times, profile), CostsOfDay.constant(distances)],
        clock=0,
        service=service,
        earliest=6.5 * HOUR,
        latest=8 * HOUR,
        ends=CLOSED,
    )


def _travel(places: Array, times: Array, profile: str) -> CostsOfDay:
    if profile == "tide":
        from_middle = np.linalg.norm(places - 0.5, axis=1)
        inward = from_middle[:, np.newaxis] > from_middle
        morning, evening = (np.where(each, PEAK, 1.0) * times for each in (inward, inward.T))
        layers = np.array([0, 1, 0, 2, 0])
        return CostsOfDay(BEGINS, np.ones(5), layers, np.stack([times, morning, evening]))
    afternoon = PEAK if profile == "two peaks" else 1.0
    factors = np.array([1.0, PEAK, 1.0, afternoon, 1.0])
    return CostsOfDay(BEGINS, factors, np.zeros(5, np.int64), times[np.newaxis])


def measured(actor: Any, day: Day, long: float = LONG) -> dict[str, Any]:
    """The share of the box that each front dominates, and whether ours covers that of means."""
    fronts = {
        "ours": _ours(actor, day, BRIEF),
        "means": _of_means(actor, day),
        "static": _static(actor, day),
        "long": _ours(actor, day, long),
    }
    points = np.concatenate(list(fronts.values()))
    least = points.min(axis=0)
    reference_point = _ABOVE * points.max(axis=0) - least
    shares = {k: hypervolume(each - least, reference_point) for k, each in fronts.items()}
    return {name: round(100 * share, 4) for name, share in shares.items()}


def _options(seconds: float) -> PlanOptions:
    directions = from_angles(fan(SIZE))
    return PlanOptions(directions=directions, size=SIZE, time_limit=seconds, fewer=True)


def _ours(actor: Any, day: Day, seconds: float) -> Array:
    under_means = partial(plan, actor, day.instance)
    return plan_over_the_day(under_means, day, _options(seconds)).points


def _of_means(actor: Any, day: Day) -> Array:
    """Points of tours planned under mean costs, both ways, each at its best departure."""
    tours = plan(actor, day.instance, _options(BRIEF)).tours
    both = np.concatenate((tours, np.roll(tours[:, ::-1], 1, axis=1)))
    return DaySearch(day, 0).driven(both, Watch()).best().points


def _static(actor: Any, day: Day) -> Array:
    """Points of tours planned at the speeds of the night, at the best of a hundred departures."""
    matrices = np.stack([each.matrices[each.layers[0]] for each in day.costs])
    tours = plan(actor, Instance(matrices=matrices), _options(BRIEF)).tours
    best: Array | None = None
    for departure in np.linspace(day.earliest, day.latest, DEPARTURES):
        fixed = Day(day.costs, day.clock, day.service, departure, departure, day.ends)
        points = DaySearch(fixed, 0).driven(tours, Watch()).points
        best = points if best is None else np.minimum(best, points)
    assert best is not None
    return best[nondominated(best)]
