"""Make child processes run the code of this one, whatever the current directory holds.

Python puts the current directory before all installed packages when it is started with -m or -c,
as most children are. A folder that holds a package `service`, or any other name that is imported,
would then stand in for the one that this process runs.
"""

import os
import sys


def variables() -> dict[str, str]:
    """Return the environment variables by which a process imports what this one would import."""
    folders = os.pathsep.join(os.path.abspath(folder) for folder in sys.path)
    return {"PYTHONSAFEPATH": "1", "PYTHONPATH": folders}


def keep_for_children() -> None:
    """Have processes that are started from now on import what this one would import."""
    os.environ.update(variables())
