"""Results in files, each with the commit, processor and date that it was measured at."""

import json
import platform
import shutil
import subprocess
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

RESULTS = Path(__file__).parent / "results"
PAGE = Path(__file__).parent / "RESULTS.md"
ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "service/guide/pictures"
ANEW = ROOT / "runs/benchmarks"  # where a run writes that does not store: git ignores it

_EXTENTS = ("instances", "minutes", "visitors", "frames", "rounds")  # of how much was measured
_OCCURRED = ("statuses", "answers", "tracebacks", "long_bodies")  # counts of what came up
_NOTES = ("measured_at",)  # on a commit
_MADE = (
    ":!tests/benchmarks/results",
    ":!tests/benchmarks/RESULTS.md",
    ":!service/guide/pictures",
)  # by benchmarks themselves


class Unstored(NamedTuple):
    """Rows that were measured and not stored, and why they were not."""

    rows: dict[str, Any]
    reason: str


class Run(NamedTuple):
    """Whether a run measures rows that are stored, and whether it writes tracked files."""

    again: bool = False
    stores: bool = True

    @property
    def folder(self) -> Path:
        """Where results are read and written."""
        return RESULTS if self.stores else ANEW


RUN = Run()  # of this process; the command sets it
UNSTORED: dict[str, Unstored] = {}  # by benchmark, of this process


def provenance(threads: int) -> dict[str, Any]:
    """Return commit, processor, version of Python, threads and date of a measurement."""
    return {
        "commit": _git("rev-parse", "--short", "HEAD") + ("-dirty" if changed_files() else ""),
        "cpu": _cpu(),
        "python": platform.python_version(),
        "threads": threads,
        "date": datetime.now(UTC).date().isoformat(),
    }


def changed_files() -> list[str]:
    """Return the tracked files that differ from the commit, but for what benchmarks write."""
    return _git("diff", "HEAD", "--name-only", "--", ".", *_MADE).splitlines()


def load(name: str) -> dict[str, Any]:
    """Return the results of a benchmark in the run's folder, an empty dictionary without any."""
    path = RUN.folder / f"{name}.json"
    stored: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    return stored


def begin(run: Run) -> None:
    """Begin a run; results that an earlier run left in `ANEW` are removed."""
    global RUN
    RUN = run
    if not run.stores:
        shutil.rmtree(ANEW, ignore_errors=True)


def picture(path: Path) -> Path:
    """Return where a run draws a picture whose tracked file has this path."""
    if RUN.stores:
        return path
    ANEW.mkdir(parents=True, exist_ok=True)
    return ANEW / path.name


def store(name: str, results: dict[str, Any], partial: str = "") -> None:
    """Write the results of a benchmark, unless stored ones are worth more.

    They are not written where the code was not that of a commit, nor where they lack something
    that is stored: a row, an instance, a minute. Then the rows that differ go into `UNSTORED`.
    A run that does not store writes all of them, into `ANEW`.

    Args:
        name: The benchmark.
        results: All of its results, those that are stored too.
        partial: Why they are of less than a whole run, where they do not show it themselves.
    """
    stored = load(name)
    if results == stored:
        UNSTORED.pop(name, None)
        return
    reason = _reason(stored, results, partial)
    if reason:
        rows = {key: value for key, value in results.items() if stored.get(key) != value}
        UNSTORED[name] = Unstored(rows, reason)
        return
    UNSTORED.pop(name, None)
    RUN.folder.mkdir(parents=True, exist_ok=True)
    (RUN.folder / f"{name}.json").write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")


def _reason(stored: dict[str, Any], results: dict[str, Any], partial: str) -> str:
    """Return why results are not stored, an empty string where they are."""
    if not RUN.stores:
        return ""
    if changed := changed_files():
        return f"the code is not that of a commit: {', '.join(changed[:3])} changed"
    if stored and partial:
        return f"the stored run is whole, and this one is not: {partial}"
    if lacking := next(_lacking(stored, results), ""):
        return f"the run lacks what is stored: {lacking}"
    return ""


def _lacking(stored: Any, new: Any, place: str = "") -> Iterator[str]:
    """Yield the places where stored results have more rows, instances or minutes than new ones."""
    if isinstance(stored, dict) and isinstance(new, dict):
        for key, value in stored.items():
            inner = f"{place}/{key}"
            if key in (*_OCCURRED, *_NOTES):
                continue
            if key not in new:
                yield inner
            elif key in _EXTENTS and isinstance(value, int | float) and new[key] < value:
                yield f"{inner} {value}, got {new[key]}"
            else:
                yield from _lacking(value, new[key], inner)
    elif isinstance(stored, list) and place.endswith(_EXTENTS) and len(new) < len(stored):
        yield f"{place} {len(stored)}, got {len(new)}"


def _git(*arguments: str) -> str:
    """Return what git prints in this repository; an empty string where there is none."""
    ended = subprocess.run(
        ["git", *arguments], cwd=ROOT, capture_output=True, text=True, encoding="utf-8"
    )
    return ended.stdout.strip()


def _cpu() -> str:
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor()
