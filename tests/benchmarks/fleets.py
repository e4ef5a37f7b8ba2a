"""`python -m tests.benchmarks fleets`: fronts of fleets, beside PyVRP in the same seconds.

Everything is on one thread. We plan as `paretour.plan_fleet` does, from the request to the answer.
Every plan is checked. The sets, of which `--sets` chooses:

- `uniform`: places uniform in a square, demands 1 to 29, capacity 200; total against longest route.
  PyVRP in a sweep of limits, and alone for the least total.
- `bi-cvrp`: as in the literature on neural solvers: the unit square, demands 1 to 9, capacity 30,
  40 and 50 at 20, 50 and 100 customers; total against longest route, also without a search.
  PyVRP and OR-Tools in a sweep.
- `streets`: orders on the streets of Helsinki, every third for an hour, after which it is late:
  the example of six vans, and as many vans for each of 400 orders; driving against lateness, and
  the longest route as well. The earlier engine, which `git` must still have.
- `reloads`: few vehicles that load three or four times a day, half of the stops with windows; total
  against longest route. PyVRP alone.
- `x`: CVRPLIB X, total against longest route: how far the least total is above the best known.
  PyVRP alone.
- `hfvrp`: mixed fleets of Pessoa, Sadykov and Uchoa (2018), total cost against longest route: how
  far the least cost is above that of the best known routes.
- `solomon`, `homberger`, `li-lim`: distance against vehicles. PyVRP, and if `--methods` names them
  VROOM and OR-Tools, plan twice, with the whole time for each end.
- `longest`: six of Solomon's, distance against longest route. PyVRP in a sweep.

The last six are read by the service from files in the folder `--data`, or in folders in it. They
are at CVRPLIB (X and Solomon, with .sol files of the best known routes: also in github.com/PyVRP/
VRPLIB, tests/data/cvrplib), in github.com/PyVRP/Instances (HFVRP) and at sintef.no/projectweb/top
(the others: also in github.com/Thundercok/VRPTW-Research-Optimization, data, and github.com/akjjan/
pdptw_alns, pdp_100).

Prints tables, and stores `results/fleets.json`; what is stored is not measured again. All of it
takes three hours on one quiet core: `bi-cvrp` one, `solomon` and `li-lim` half an hour each,
`x` and `homberger` 20 minutes each, `hfvrp` and `streets` ten, `uniform` six, `reloads` three and
`longest` two.
"""

import argparse
from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from paretour import Refused
from paretour.bars import Silent
from paretour.plans import FleetFront
from paretour.requests import fleet_plan

from service.fleet.evaluation import points_of
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route
from service.library.local_planner import LocalPlanner, load_planner
from tests.benchmarks.best_known import HOMBERGER, LI_LIM, SOLOMON, names_of
from tests.benchmarks.fleet_fronts import timed_front
from tests.benchmarks.fleet_instances import (
    FleetInstance,
    bi_cvrp,
    read_instance,
    reloading,
    settings,
    uniform,
)
from tests.benchmarks.fleet_table import (
    ALONE,
    BI_CVRP,
    EARLIER,
    NO_SEARCH,
    OR_TOOLS,
    OR_TOOLS_SWEEP,
    OURS,
    SWEEP,
    VROOM,
    table_of,
)
from tests.benchmarks.rivals import earlier_fleets
from tests.benchmarks.rows import resume_beside
from tests.benchmarks.street_fleets import street_fleets

Find = Callable[[FleetInstance, float], Sequence[Plan]]

STREETS = {59: 1, 400: 3}  # orders, and instances of so many
_SECONDS_OF_STREETS = (8.0, 20.0)
X = (
    *("X-n101-k25", "X-n200-k36", "X-n303-k21", "X-n401-k29", "X-n502-k39", "X-n599-k92"),
    *("X-n701-k44", "X-n801-k40", "X-n895-k37", "X-n1001-k43"),
)
HFVRP = (
    *("X101-FSMFD", "X106-FSMD", "X110-HD", "X115-HVRP", "X120-FSMF"),
    *("X200-HD", "X204-FSMD", "X209-FSMFD", "X214-HVRP", "X256-FSMF"),
)
LONGEST = ("C101", "C201", "R101", "R201", "RC101", "RC201")
_RIVALS = {  # the module and the function of each, which takes a fleet and seconds
    SWEEP: "pyvrp_fleets.swept",
    ALONE: "pyvrp_fleets.least_total",
    OR_TOOLS_SWEEP: "ortools_fleets.swept",
}
_RIVALS_OF_ENDS = {
    ALONE: "pyvrp_fleets.both_ends",
    VROOM: "vroom_fleets.both_ends",
    OR_TOOLS: "ortools_fleets.both_ends",
}


class Files(NamedTuple):
    """A set that is read from files."""

    names: Sequence[str]
    seconds: float
    methods: Sequence[str]
    counts_vehicles: bool = True


class Recipe(NamedTuple):
    """A set that is made, three instances of each size."""

    make: Callable[[int, int], FleetInstance]
    sizes: Sequence[int]
    methods: Sequence[str]


RECIPES = {
    "uniform": Recipe(uniform, (100, 250, 480, 1000, 2000), (OURS, SWEEP, ALONE)),
    "reloads": Recipe(reloading, (50, 100, 200), (OURS, ALONE)),
}
_ENDS = (OURS, ALONE)
FILES = {
    "x": Files(X, 60.0, (OURS, ALONE), counts_vehicles=False),
    "hfvrp": Files(HFVRP, 60.0, (OURS,), counts_vehicles=False),
    "solomon": Files(names_of(SOLOMON), 10.0, _ENDS),
    "homberger": Files(names_of(HOMBERGER), 60.0, _ENDS),
    "li-lim": Files(names_of(LI_LIM), 10.0, _ENDS),
    "longest": Files(LONGEST, 10.0, (OURS, SWEEP), counts_vehicles=False),
}
SETS = ("uniform", "bi-cvrp", "streets", "reloads", *FILES)


class Group(NamedTuple):
    """Instances that are one row of each method, and how long they are planned."""

    name: str
    instances: Sequence[FleetInstance]
    seconds: float
    methods: Sequence[str]
    counts_vehicles: bool = False


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks fleets", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--sets", nargs="+", choices=SETS, default=SETS)
    parser.add_argument("--data", type=Path, help="a folder of the files of instances")
    parser.add_argument(
        "--names", nargs="+", default=[], help="of files, in capitals, without .txt"
    )
    parser.add_argument("--sizes", type=int, nargs="+", default=[], help="of recipes")
    parser.add_argument("--count", type=int, help="instances of each size: 3, or of bi-cvrp 200")
    parser.add_argument("--seconds", type=float, help="by default as said for each set")
    parser.add_argument("--methods", nargs="+", default=[], help="names of rows")
    options = parser.parse_args(arguments)
    if options.data is None and set(options.sets) & set(FILES):
        parser.error(f"{', '.join(set(options.sets) & set(FILES))}: --data must name a folder")
    for name in options.sets:
        for group in _groups(name, options):
            _measure(name, group, options)
        print(table_of(name))


def _groups(name: str, options: argparse.Namespace) -> Iterator[Group]:
    """Yield the groups of instances of a set."""
    if name in RECIPES:
        recipe = RECIPES[name]
        for n in options.sizes or recipe.sizes:
            made = [recipe.make(n, seed) for seed in range(options.count or 3)]
            yield Group(f"{n} stops", made, 8.0, recipe.methods)
    elif name == "bi-cvrp":
        for n in options.sizes or BI_CVRP:
            made = [bi_cvrp(n, seed) for seed in range(options.count or 200)]
            methods = (NO_SEARCH, OURS, SWEEP, OR_TOOLS_SWEEP)
            yield Group(f"{n} customers", made, BI_CVRP[n].seconds, methods)
    elif name == "streets":
        yield from _of_streets(options)
    else:
        files = FILES[name]
        for each in options.names or files.names:
            read = read_instance(options.data, each, counts_vehicles=files.counts_vehicles)
            yield Group(each, [read], files.seconds, files.methods, files.counts_vehicles)


def _of_streets(options: argparse.Namespace) -> Iterator[Group]:
    for n in options.sizes or STREETS:
        for count in (2, 3):
            made = street_fleets(n, objectives=count, instances=options.count or STREETS[n])
            for seconds in (options.seconds,) if options.seconds else _SECONDS_OF_STREETS:
                group = f"{n} orders, {count} objectives, {seconds:g} s"
                yield Group(group, made, seconds, (OURS, EARLIER))


def _measure(name: str, group: Group, options: argparse.Namespace) -> None:
    """Measure a group by all methods, one instance after another, and store the rows."""
    seconds = options.seconds or group.seconds
    measures = {}
    for method in {OURS, EARLIER} & set(group.methods):
        _method(method, group.counts_vehicles)(group.instances[0], 0.1)  # compiled before it counts
    for method in options.methods or group.methods:
        limit = 0.0 if method == NO_SEARCH else seconds
        find = _method(method, group.counts_vehicles)
        measures[f"{name}: {group.name}, {method}, {limit:g} s"] = partial(measured, find, limit)
    resume_beside("fleets", measures, group.instances)


def _method(name: str, counts_vehicles: bool) -> Find:
    """Return a method by its name. The libraries of others are imported where they are used."""
    if name in (OURS, NO_SEARCH):
        return ours
    if name == EARLIER:
        return earlier
    rivals = _RIVALS_OF_ENDS if counts_vehicles else _RIVALS
    module, _, function = rivals[name].partition(".")
    find: Callable[[Fleet, float], list[Plan]] = getattr(
        import_module(f"tests.benchmarks.rivals.{module}"), function
    )
    return lambda instance, seconds: find(instance.fleet, seconds)


def measured(find: Find, seconds: float, instance: FleetInstance) -> dict[str, Any]:
    """Return the seconds it took, the points of the plans found, and the least distance known."""
    spent, points = timed_front(partial(find, instance, seconds), instance.fleet)
    found = {"seconds": spent, "points": points.round(6).tolist()}
    known = instance.least_known
    return found if known is None else {**found, "least_known": known}


def ours(instance: FleetInstance, seconds: float) -> list[Plan]:
    """Return the plans of the answer; none where it is that none was found."""
    try:
        planned = _planner().plan(
            fleet_plan({**instance.request, "time_limit": seconds}),  # type: ignore[typeddict-item]
            Silent(),
        )
    except Refused as refused:
        if refused.code != "no-plan":
            raise
        return []
    front = planned.front()
    assert isinstance(front, FleetFront)
    numbers = {stop["id"]: number for number, stop in enumerate(instance.request["stops"])}
    plans = [
        Plan(tuple(Route(0, tuple(numbers[stop] for stop in each.stops[1:-1])) for each in routes))
        for routes in (plan.routes for plan in front.plans)
    ]
    np.testing.assert_allclose(front.lengths, points_of(instance.fleet, plans), rtol=1e-9)
    return plans


def earlier(instance: FleetInstance, seconds: float) -> list[Plan]:
    """Return the plans of the earlier engine."""
    return earlier_fleets.front_of({**instance.request, "time_limit": seconds})


@cache
def _planner() -> LocalPlanner:
    return load_planner(settings())
