"""Measurements that may be broken off: what is stored is not measured again."""

import os
from collections.abc import Callable, Sequence
from typing import Any

from tqdm import tqdm

from service.instance import Instance
from tests.benchmarks.provenance import load, provenance, store


def resume(
    benchmark: str,
    key: str,
    digest: str,
    instances: Sequence[Instance],
    measure: Callable[[Instance], Any],
) -> None:
    """Measures the instances that have no result yet, storing after each.

    Results of another network, known by its digest, are measured anew. Beside the results it
    stores where they come from, and how many programs wanted the processor when they began.
    """
    results = load(benchmark)
    if results.get(key, {}).get("digest") != digest:
        busy = round(os.getloadavg()[0] / (os.cpu_count() or 1), 1)
        results[key] = {**provenance(1), "digest": digest, "busy": busy, "instances": []}
    entries = results[key]["instances"]
    for instance in tqdm(instances[len(entries) :], desc=key, leave=False):
        entries.append(measure(instance))
        store(benchmark, results)
