"""Kernels of a module of a test, in a process of their own."""

import os
import subprocess
import sys
from pathlib import Path


def printed(folder: Path, code: str, **variables: str) -> str:
    """Return what code prints in a new process that keeps compiled code in a folder.

    The code sees the names of the folder's module `kernels`. It must not warn.
    """
    environment = {
        **os.environ,
        "NUMBA_CACHE_DIR": str(folder),
        "PYTHONPATH": f"{folder}:.",
        **variables,
    }
    command = [sys.executable, "-W", "error", "-c", f"from kernels import *\n{code}"]
    ran = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert ran.stderr == ""
    return ran.stdout
