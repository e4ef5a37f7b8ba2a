"""Import the modules of all workers once, in the process that forks them.

Workers then start with these modules, and with the compiled code if an earlier process left it in
the cache. If not, one worker compiles it later: that takes most of a minute, and there are no
workers, not even for requests of the network alone, until this module is imported.

Do not import the service or ONNX Runtime: a fork copies the locks of their threads, but not the
threads.
"""

import scipy.ndimage  # noqa: F401  # as the first survey does

import service.kinds.run  # noqa: F401
from service.jobs.compiled_code import load_from_cache
from service.jobs.parts import Part
from service.jobs.workers import messages  # noqa: F401
from service.requests import road_measurer  # noqa: F401

for part in Part:
    if not load_from_cache(part):
        break
