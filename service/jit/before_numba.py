"""Ignore variables with which numba could not be imported. This module is imported before numba.

numba refuses to be imported where NUMBA_NUM_THREADS is not positive. That is the number of threads
of parallel functions, and there are none here.
"""

import os

IGNORED = "NUMBA_NUM_THREADS"
os.environ.pop(IGNORED, None)
