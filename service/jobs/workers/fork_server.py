"""The process that workers are forked from, once it has imported their modules.

This takes it two seconds. So the command `serve` starts it before it imports its own modules, and
this module imports none of these.
"""

import multiprocessing
import os
import signal
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import forkserver, resource_tracker

CONTEXT = multiprocessing.get_context("forkserver")
CONTEXT.set_forkserver_preload(["service.jobs.workers.preloaded"])
# Python puts the socket of the fork server at TMPDIR/pymp-12345678/listener-12345678.
_LONGEST_FOLDER = 107 - 32  # bytes; the path of a socket has at most 107
_SHORT_FOLDERS = ("/tmp", "/var/tmp", "/dev/shm")


def start() -> None:
    """Start the process unless it runs, and return before it has imported anything.

    An interrupt from a terminal goes to it too, and does not concern it: it ends with this process.
    """
    if len(os.fsencode(tempfile.gettempdir())) > _LONGEST_FOLDER:
        usable = (each for each in _SHORT_FOLDERS if os.access(each, os.W_OK | os.X_OK))
        tempfile.tempdir = next(usable, tempfile.tempdir)
    resource_tracker.ensure_running()  # else it is started by the next, and allows interrupts again
    with interrupts_blocked():  # the process begins with them blocked too
        forkserver.ensure_running()


@contextmanager
def interrupts_blocked() -> Iterator[None]:
    """Let Ctrl-C wait until the end: a module that it interrupts may fail with another error."""
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
