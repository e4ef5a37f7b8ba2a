"""Results in files, each with the commit, processor and date that it was measured at."""

import json
import platform
import subprocess
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).parent / "results"


def provenance(threads: int) -> dict[str, Any]:
    """Return commit, processor, version of Python, threads and date of a measurement."""
    described = ["git", "describe", "--always", "--dirty", "--exclude", "*"]
    return {
        "commit": subprocess.run(described, capture_output=True, text=True).stdout.strip(),
        "cpu": _cpu(),
        "python": platform.python_version(),
        "threads": threads,
        "date": datetime.now(UTC).date().isoformat(),
    }


def load(name: str) -> dict[str, Any]:
    """Return the stored results of a benchmark: an empty dictionary if it has not run."""
    path = RESULTS / f"{name}.json"
    stored: dict[str, Any] = json.loads(path.read_text()) if path.exists() else {}
    return stored


def store(name: str, results: dict[str, Any]) -> None:
    """Write the results of a benchmark."""
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / f"{name}.json").write_text(json.dumps(results, indent=2) + "\n")


def _cpu() -> str:
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor()
