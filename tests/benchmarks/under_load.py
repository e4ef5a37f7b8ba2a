"""What `load`, `soak` and `attack` found, in tables, beside what they must find."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from tests.benchmarks.demands import (
    ASIDE_MS,
    GROWTH,
    LATENESS,
    MEGABYTES,
    MORE_SECONDS,
    SHARE,
    WORKERS,
    added_seconds,
    unmet_by_attack,
    unmet_by_load,
    unmet_by_soak,
)
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load

Row = tuple[str, str, str]
_WHEN = {"under_full_load": "full load", "with_long_bodies": "and long bodies"}


def section() -> str:
    """What is stored of the three."""
    return (
        "## The service under load\n\nNot in the paper: `python -m tests.benchmarks load`. 40 "
        "cities, 100 preferences, `time_limit` 0, no repairs;\nclients, server and workers "
        "share the cores. Bare sessions are the same network in a loop: one a core, each in\na "
        "process of its own with one thread, as in the server, or a single one with all cores\nfor "
        "each call. Eight clients a core ask again as soon as they are answered. Requests at\n"
        "random come as those of independent people do, which gives even an ideal server a ratio\n"
        "of 3.9. Long bodies have 10 MB: matrices, cities by the hundred thousand, brackets, "
        "gzip.\n\n"
        f"{_part(load('load'), load_rows, unmet_by_load)}\n"
        "`python -m tests.benchmarks soak`: visitors who plan 10 to 500 cities, misuse, hang up, "
        "order, watch\nand cancel jobs.\n\n"
        f"{_part(load('soak'), soak_rows, unmet_by_soak)}\n"
        "`python -m tests.benchmarks attack`: honest requests, two a second, beside crowds that "
        "attack, each\nfrom an address of its own: stalled uploads of 16 MB, idle connections, "
        "hang-ups, repeats of a key on\na full queue, hostile bodies; 1,024 descriptors, no "
        "rate.\n\n"
        f"{_part(load('attack'), attack_rows, unmet_by_attack)}"
    )


def load_table(results: Mapping[str, Any]) -> str:
    """What `load` found."""
    return _table(load_rows(results))


def soak_table(results: Mapping[str, Any]) -> str:
    """What `soak` found."""
    return _table(soak_rows(results))


def attack_table(results: Mapping[str, Any]) -> str:
    """What `attack` found."""
    return _table(attack_rows(results))


def load_rows(results: Mapping[str, Any]) -> Iterator[Row]:
    """What, what was found, and what is demanded of it."""
    bare, apart, served = results["bare"], results["apart"], results["served"]
    yield "seconds of each measurement", f"{results['seconds']:g}", ""
    yield "a session with all cores, calls a second", _mean(bare, "per_second"), ""
    yield "bare sessions, one a core, calls a second", _mean(apart, "per_second"), ""
    yield "answers a second", _mean(served, "per_second"), ""
    share = results["share_of_apart"]
    yield "their share of bare sessions' calls", f"{share:.1%}", f"at least {SHARE:.0%}"
    yield "bare session, ms of the processor a call", _mean(apart, "session_ms"), ""
    for who in ("workers", "server", "clients"):
        yield f"{who}, ms of the processor an answer", _mean(served, f"{who}_ms"), ""
    yield "session's share of the processor", f"{results['processor_share']:.1%}", ""
    evenly, at_random = results["at_80_percent"], results["at_80_percent_at_random"]
    yield "80 % of that, evenly: median, p99, ratio", _lateness(evenly), f"under {LATENESS:g}"
    yield "80 % of that, at random: median, p99, ratio", _lateness(at_random), ""
    for when, said in _WHEN.items():
        for path, aside in results[when].items():
            found = f"{aside['p99_ms']:.1f} ms, {aside['worst_ms']:.1f} ms"
            yield f"`{path}`, {said}: p99, worst", found, f"at most {ASIDE_MS:g} ms"
    for kind, statuses in results["long_bodies"].items():
        yield f"long bodies, {kind}: statuses", _counted(statuses), ""


def soak_rows(results: Mapping[str, Any]) -> Iterator[Row]:
    """What, what was found, and what is demanded of it."""
    yield "minutes, visitors", f"{results['minutes']:g}, {results['visitors']}", ""
    for deed, statuses in sorted(results["answers"].items()):
        yield f"{deed}: statuses", _counted(statuses), ""
    yield "jobs", _counted(results["jobs"]), "as many ends as accepted, none failed"
    yield "faults", str(len(results["faults"])), "0"
    yield "tracebacks in the log", str(results["tracebacks_in_log"]), "0"
    yield "exit status at SIGTERM", str(results["exit_status"]), "0"
    memory = results["megabytes"]
    yield "resident memory at first, at last", f"{memory[0]:.0f} MB, {memory[-1]:.0f} MB", ""
    growth = f"{results['growth_over_last_half']:+.1%}"
    yield "its growth over the last half", growth, f"under {GROWTH:.0%}"


def attack_rows(results: Mapping[str, Any]) -> Iterator[Row]:
    """What, what was found, and what is demanded of it."""
    yield "minutes", f"{results['minutes']:g}", ""
    yield "mean load of the machine, 15 minutes", f"{results['busy']:g}", ""
    for when, said in (("quiet", "in quiet"), ("beside", "beside the crowds")):
        found = results[when]
        times = (found["median_ms"], found["p99_ms"], found["worst_ms"])
        yield f"honest requests {said}: statuses", _counted(found["statuses"]), "200"
        said_times = ", ".join(f"{each:.0f} ms" for each in times)
        yield f"honest requests {said}: median, p99, worst", said_times, ""
    yield "worst, more than in quiet", f"{added_seconds(results):.2f} s", f"{MORE_SECONDS:g} s"
    for name, seen in results["crowds"].items():
        yield f"{name}: statuses", _counted(seen["answers"]), ""
        yield f"{name}: faults", str(len(seen["faults"])), "0"
    yield "most memory", f"{results['megabytes']} MB", f"at most {MEGABYTES} MB"
    yield "workers lost", str(results["workers_lost"]), "0"
    yield "workers afterwards", str(results["workers_present"]), str(WORKERS)
    yield "tracebacks in the log", str(results["tracebacks_in_log"]), "0"
    yield "exit status at SIGTERM", str(results["exit_status"]), "0"


def _part(
    stored: Mapping[str, Any],
    rows: Callable[[Mapping[str, Any]], Iterable[Row]],
    unmet: Callable[[Mapping[str, Any]], Iterable[str]],
) -> str:
    if not stored:
        return "Not measured.\n"
    origin = f"{stored['cpu']}, {stored['threads']} cores, {stored['date']}, `{stored['commit']}`"
    below = "".join(f"\n- {each}" for each in unmet(stored)) or " nothing."
    return f"{_table(rows(stored))}\nMeasured on: {origin}. Does not hold:{below}\n"


def _table(rows: Iterable[Row]) -> str:
    return table(("", "found", "demanded"), rows)


def _mean(rows: Iterable[Mapping[str, float]], name: str) -> str:
    return f"{np.mean([row[name] for row in rows]):.2f}"


def _lateness(timed: Mapping[str, float]) -> str:
    ratio = timed["p99_ms"] / timed["median_ms"]
    return f"{timed['median_ms']:.1f} ms, {timed['p99_ms']:.1f} ms, {ratio:.2f}"


def _counted(counted: Mapping[str, int]) -> str:
    return ", ".join(f"{name}: {count}" for name, count in sorted(counted.items())) or "none"
