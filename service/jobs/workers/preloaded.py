"""Import the modules of all workers once, in the process that forks them.

Workers then start with these modules, and with the compiled code if an earlier process left it in
the cache. If not, other processes compile it, which takes most of a minute. No worker starts
before this module is imported, not even for requests of the network alone.

The garbage collector waits meanwhile, and later leaves out what was loaded here: to look through
that is to write to it, and workers share this memory as long as none of them writes.

Do not import the service or ONNX Runtime: a fork copies the locks of their threads, but not the
threads.
"""

import gc
from contextlib import suppress
from importlib import import_module

from service.jobs.uncollected import uncollected

# An error here would end this process, and nobody would be told why. Without it each worker imports
# the modules again, meets the error again, and tells the service.
with uncollected(), suppress(Exception):
    from service.jobs.compiled_code import load_or_begin

    load_or_begin()  # before the other modules, as it lasts longest
    for name in ("service.jobs.workers.messages", "service.kinds.table"):
        import_module(name)
gc.freeze()
