"""A store of the version before, 0.2.0: fronts of every kind, an unfinished one, and its answers.

Stored fronts and jobs outlive a version, so that each has to read those of the one before.
"""

import gzip
import json
from pathlib import Path
from typing import Any

_EXAMPLES = Path(__file__).parents[1] / "jobs" / "examples"

ANSWERS: dict[str, dict[str, Any]] = json.loads((_EXAMPLES / "fronts-of-0.2.0.json").read_text())
UNFINISHED = "waiting"
CALLER = "anonymous"
NOW = 1001.0  # a second after its fronts were stored


def write_store(path: Path) -> Path:
    """Write the file of the store, and return its path."""
    content = (_EXAMPLES / "fronts-of-0.2.0.sqlite.gz").read_bytes()
    path.write_bytes(gzip.decompress(content))
    return path
