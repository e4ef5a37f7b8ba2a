"""Import what workers are forked with, once, in the process that forks them.

They have these modules then, and the compiled code, where an earlier process has left it in the
cache. Where it has not, one of them compiles it: that takes minutes, and until this is imported
there are no workers, not even for what the network does alone.

Not the service nor ONNX Runtime: a fork copies the locks of their threads, but not the threads.
"""

import scipy.linalg  # numba imports it when it first loads compiled code
import scipy.ndimage  # noqa: F401  # as the first survey does

from service.jobs.compiled_code import load_from_cache
from service.jobs.workers import messages  # noqa: F401
from service.requests import road_measurer  # noqa: F401

load_from_cache()
