"""Another numba may lack a name that it does not document: it compiles all the same."""

import os
import subprocess
import sys
from pathlib import Path

# Nothing in numba itself looks this name up any more.
LACKING = """
import numba.core.caching
import numpy as np
del numba.core.caching.InTreeCacheLocator
from service.search.best_subset import best_subset
from service.search.front_points import FrontPoints
points = np.stack([np.arange(9.0), 9 - np.arange(9.0)], axis=1)
print(best_subset(FrontPoints(points, np.full(2, 10.0)), 3))
"""


def test_where_numba_lacks_a_name_it_compiles_as_it_is_and_a_warning_says_which(
    tmp_path: Path,
) -> None:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    found = {}
    for code in (LACKING, LACKING.replace("del ", "")):
        command = [sys.executable, "-c", code]
        ran = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        found[ran.stderr] = ran.stdout
    assert list(found) == [
        "numba has no numba.core.caching.InTreeCacheLocator.from_function:"
        " it compiles for longer, and the search is slower\n",
        "",
    ]
    assert len(set(found.values())) == 1
