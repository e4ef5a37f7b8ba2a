"""Make child processes import the same code as this process.

Most children are started with -m or -c. Python then looks for packages in the current directory
first. If that holds a folder `service`, or another name that is imported, children would run it.
"""

import os
import sys


def variables() -> dict[str, str]:
    """Return the environment variables with which a process imports the same code as this one."""
    folders = os.pathsep.join(os.path.abspath(folder) for folder in sys.path)
    return {"PYTHONSAFEPATH": "1", "PYTHONPATH": folders}


def keep_for_children() -> None:
    """Make processes that are started from now on import the same code as this one."""
    os.environ.update(variables())
