"""Rows of tables: how an instance is measured, and how a row that was broken off goes on."""

import os
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from service.instance import Instance
from service.pareto import hypervolume
from tests.benchmarks import provenance as of_run
from tests.benchmarks.instances import reference_points
from tests.benchmarks.provenance import load, provenance, store

Points = NDArray[np.float64]
Each = TypeVar("Each")  # an instance, as the benchmark measures it

TOURS = 100  # of a front


class Method(NamedTuple):
    """How points are found; whether the first time takes longer; the digest of a network."""

    find: Callable[[Instance], Points]
    fills_caches: bool = False
    digest: str = ""


def measured(method: Method, instance: Instance) -> dict[str, Any]:
    """Seconds, and the hypervolume in per cent by reference point."""
    began = time.process_time()
    points = method.find(instance)
    seconds = time.process_time() - began
    corners = reference_points(instance.n).items()
    shares = {name: round(100 * hypervolume(points, corner), 4) for name, corner in corners}
    return {"seconds": round(seconds, 4), "hypervolume": shares}


def resume(
    benchmark: str,
    key: str,
    digest: str,
    instances: Sequence[Each],
    measure: Callable[[Each], Any],
) -> None:
    """Measures the instances that have no result yet, storing after each.

    With `--again`, and where they are of another network, known by its digest, all are measured,
    and take the place of the stored ones once they are as many. Beside the results it
    stores where they come from, and how many programs wanted the processor when they began.
    """
    resume_beside(benchmark, {key: measure}, instances, digest)


def resume_beside(
    benchmark: str,
    measures: Mapping[str, Callable[[Each], Any]],
    instances: Sequence[Each],
    digest: str = "",
) -> None:
    """Measures rows as `resume` does, one instance after another: each in all rows by their keys.

    So what else the machine does is the same for all of them.
    """
    results = load(benchmark)
    for key in measures:
        if of_run.RUN.again or results.get(key, {}).get("digest") != digest:
            busy = round(os.getloadavg()[0] / (os.cpu_count() or 1), 1)
            results[key] = {**provenance(1), "digest": digest, "busy": busy, "instances": []}
    for index, instance in enumerate(tqdm(instances, desc=next(iter(measures)), leave=False)):
        for key, measure in measures.items():
            entries = results[key]["instances"]
            if len(entries) == index:
                entries.append(measure(instance))
                store(benchmark, results)
