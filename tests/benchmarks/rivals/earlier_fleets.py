"""The earlier engine of fleets: sweeps of searches by PyVRP, of whole numbers and one cost each.

Its code is taken out of this repository's history into `runs/earlier`, once, and runs in a process
of its own.
"""

import io
import json
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

from service.fleet.plans import Plan, Route
from tests.benchmarks.provenance import ROOT

COMMIT = "e0d108ee"
_FOLDER = ROOT / "runs/earlier" / COMMIT
_SEARCH = Path(__file__).with_name("earlier_search.py")


def front_of(request: dict[str, Any]) -> list[Plan]:
    """Return the plans that it finds for a request of POST /fleet of one type of vehicles."""
    process = _process()
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(json.dumps(request) + "\n")
    process.stdin.flush()
    plans = json.loads(process.stdout.readline())
    return [Plan(tuple(Route(0, tuple(stops)) for stops in routes)) for routes in plans]


@cache
def _process() -> subprocess.Popen[str]:
    """Return the running process; it ends with this one, as its input does."""
    if not _FOLDER.exists():
        _unpack()
    path = os.pathsep.join(map(str, (_FOLDER, _FOLDER / "service/client")))
    return subprocess.Popen(
        [sys.executable, str(_SEARCH)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        encoding="utf-8",
        cwd=_FOLDER,
        env={**os.environ, "PYTHONPATH": path},
    )


def _unpack() -> None:
    command = ["git", "archive", COMMIT, "service"]
    packed = subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout
    _FOLDER.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=_FOLDER.parent) as folder:
        with tarfile.open(fileobj=io.BytesIO(packed)) as archive:
            archive.extractall(folder, filter="data")
        shutil.copytree(folder, _FOLDER)
