"""`python -m tests.benchmarks behind`: how far the network for matrices is behind the search.

Ten instances of 50 cities of each kind of `asymmetric`. The network alone builds a tour for each of
100 preferences in one call, as it is and with as many repairs as the service makes by default; the
search alone has one second and gives at most 100 tours. Hypervolume has the reference point
(30, 30) for entries and closed ones, where costs are divided by the largest of their objective, and
n times the scale for the others. What is stored is not measured again. Prints by how many per cent
of the search's hypervolume each call is behind, stores `results/behind.json`, and says what does
not hold.
"""

import argparse
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.actor import OnnxActor
from service.instance import Instance, tour_lengths
from service.pareto import hypervolume
from service.search.warm_up import warm_up
from tests.benchmarks.asymmetric import MORE_KINDS, asymmetric, drawn
from tests.benchmarks.beside import ACTORS, COUNT, Nothing, planned
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load
from tests.benchmarks.rows import resume

CITIES = 50
SECONDS = 1.0  # of the search
ACTOR = "pa-one-matrix"
_CORNERS = {"uniform": 30.0, "closed": 30.0}  # times the scale; of others the number of cities
_MOST = {"uniform": 3.0, "closed": 1.2, "roads": 1.0, "maps": 1.0}  # per cent behind, repaired
_CALLS = ("alone", "repaired")


def main(arguments: list[str]) -> str | None:
    """The command line. Says what does not hold."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks behind", description=__doc__)
    parser.add_argument("--count", type=int, default=COUNT, help="instances of each kind")
    options = parser.parse_args(arguments)
    actor = OnnxActor(ACTORS / f"{ACTOR}.onnx", threads=1)
    warm_up()
    for kind in ("uniform", "closed", *MORE_KINDS):
        draw = drawn if kind in MORE_KINDS else asymmetric
        instances = [draw(kind, CITIES, seed) for seed in range(options.count)]
        corner = _CORNERS.get(kind, float(CITIES))
        resume("behind", kind, actor.info.digest, instances, partial(measured, actor, corner))
    stored = load("behind")
    print(_table(stored))
    return "\n".join(unmet(stored)) or None


def measured(actor: OnnxActor, corner: float, instance: Instance) -> dict[str, float]:
    """Hypervolume in per cent of the box to a corner times the scale, by how tours were found."""
    found = {
        "alone": planned(actor, 0.0, instance),
        "repaired": planned(actor, 0.0, instance, repaired=True),
        "search": planned(Nothing(), SECONDS, instance),
    }
    reference_point = corner * instance.scale
    return {
        name: round(100 * hypervolume(tour_lengths(instance, tours), reference_point), 4)
        for name, tours in found.items()
    }


def unmet(stored: dict[str, Any]) -> list[str]:
    """Sentences on the kinds whose repaired tours are further behind than they may be."""
    means = {kind: _behind(stored[kind], "repaired").mean() for kind in _MOST if kind in stored}
    return [
        f"{kind}: {behind:.2f} % behind the search, and {_MOST[kind]:g} is the most"
        for kind, behind in means.items()
        if behind > _MOST[kind]
    ]


def _behind(entry: dict[str, Any], call: str) -> NDArray[np.float64]:
    """Return by how many per cent of the search's hypervolume a call is behind, by instance."""
    found = entry["instances"]
    return np.array([100 * (1 - each[call] / each["search"]) for each in found])


def _table(stored: dict[str, Any]) -> str:
    rows = []
    for call in _CALLS:
        behind = [_behind(entry, call) for entry in stored.values()]
        cells = [f"{each.mean():.2f} ± {each.std() / len(each) ** 0.5:.2f}" for each in behind]
        rows.append([call, *cells])
    return table(["behind the search, %", *stored], rows)
