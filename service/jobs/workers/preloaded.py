"""Import the modules of all workers once, in the process that forks them.

Workers then start with these modules, and with the compiled code if an earlier process left it in
the cache. If not, other processes compile it: that takes most of a minute, and there are no
workers, not even for requests of the network alone, until this module is imported.

Garbage is not collected meanwhile, and what is loaded is never looked through for it again: workers
share its memory as long as they do not write to it.

Do not import the service or ONNX Runtime: a fork copies the locks of their threads, but not the
threads.
"""

import gc
from importlib import import_module

from paretour.uncollected import uncollected

with uncollected():
    from service.jobs.compiled_code import load_or_begin

    load_or_begin()  # before the other modules, as it lasts longest
    for name in ("service.jobs.workers.messages", "service.kinds.run"):
        import_module(name)
gc.freeze()
