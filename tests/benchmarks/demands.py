"""What `load`, `soak` and `attack` must find, and what of it they did not find."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

SHARE = 0.9  # of the calls a second of bare sessions, one a core, answered
LATENESS = 4.0  # times the median, the 99th percentile
ASIDE_MS = 50.0  # for health and metrics, whatever else goes on
GROWTH = 0.1  # of resident memory over the last half
WORKERS = 2  # of the service that is attacked
MORE_SECONDS = 1.0  # that an honest request may take beside an attack
MEGABYTES = 2048  # of the server and its processes
_ENDS = ("done", "cancelled", "failed", "forgotten once done")


def unmet_by_load(results: Mapping[str, Any]) -> Iterator[str]:
    """A sentence for each demand that does not hold."""
    if (share := results["share_of_apart"]) < SHARE:
        yield f"answers a second must be {SHARE:.0%} of bare sessions' calls, got {share:.1%}"
    timed = results["at_80_percent"]
    if (lateness := timed["p99_ms"] / timed["median_ms"]) >= LATENESS:
        yield f"p99 must be under {LATENESS:g} times the median, got {lateness:.2f} times"
    for when in ("under_full_load", "with_long_bodies"):
        for path, times in results[when].items():
            if (worst := times["worst_ms"]) > ASIDE_MS:
                said = when.replace("_", " ")
                yield f"{path} must answer within {ASIDE_MS:g} ms {said}, got {worst:g} ms"


def unmet_by_soak(results: Mapping[str, Any]) -> Iterator[str]:
    """A sentence for each demand that does not hold."""
    jobs = results["jobs"]
    ended = sum(jobs.get(end, 0) for end in _ENDS)
    if jobs.get("accepted", 0) != ended:
        yield f"every accepted job must end, got {jobs.get('accepted', 0)} and {ended} ends"
    if jobs.get("failed"):
        yield f"no job may fail, got {jobs['failed']}"
    if results["faults"]:
        yield f"there must be no fault, got {len(results['faults'])}: {results['faults'][0]}"
    yield from _unmet_at_end(results)
    if (growth := results["growth_over_last_half"]) >= GROWTH:
        yield f"memory must grow by less than {GROWTH:.0%} over the last half, got {growth:.1%}"


def unmet_by_attack(results: Mapping[str, Any]) -> Iterator[str]:
    """A sentence for each demand that does not hold."""
    for when in ("quiet", "beside"):
        if lost := sorted(set(results[when]["statuses"]) - {"200"}):
            yield f"every honest request must be a 200, got {', '.join(lost)} ({when})"
    if (more := added_seconds(results)) > MORE_SECONDS:
        yield f"honest requests must take at most {MORE_SECONDS:g} s more, got {more:.2f} s"
    for name, seen in results["crowds"].items():
        if seen["faults"]:
            yield f"{name} must see no fault, got {seen['faults'][0]}"
    if (megabytes := results["megabytes"]) > MEGABYTES:
        yield f"memory must stay under {MEGABYTES} MB, got {megabytes} MB"
    yield from _unmet_of_workers(results)
    yield from _unmet_at_end(results)


def added_seconds(results: Mapping[str, Any]) -> float:
    """How much longer the slowest honest request took beside the attack than in quiet."""
    milliseconds = results["beside"]["worst_ms"] - results["quiet"]["worst_ms"]
    return float(milliseconds / 1000)


def _unmet_of_workers(results: Mapping[str, Any]) -> Iterator[str]:
    if results["workers_lost"]:
        yield f"no worker may be lost, got {results['workers_lost']}"
    if results["workers_present"] != WORKERS:
        yield f"{WORKERS} workers must be there afterwards, got {results['workers_present']}"


def _unmet_at_end(results: Mapping[str, Any]) -> Iterator[str]:
    if results["tracebacks_in_log"]:
        found = str(results["tracebacks_in_log"])
        if named := results.get("tracebacks"):  # which earlier runs did not store
            found += f": {'; '.join(named)}"
        yield f"the log must have no traceback, got {found}"
    if results["exit_status"]:
        yield f"the service must end with 0, got {results['exit_status']}"


def growth(memory: list[float]) -> float:
    """By what share the last tenth of the last half is above its first tenth, on average."""
    half = np.array(memory[len(memory) // 2 :])
    tenth = max(1, len(half) // 10)
    return float(half[-tenth:].mean() / half[:tenth].mean() - 1)
