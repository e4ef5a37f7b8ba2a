"""The command that works for a cluster, and says whether another that does takes work."""

import sys

from service.cli.configured import configured, loaded
from service.cli.errors import ended, explaining
from service.cluster_worker import build_work, takes_work

STALLED = 1


def run_work(workers: int | None) -> None:
    """Plan what replicas ask for until told to stop. What is None is left to the settings."""
    with explaining():
        work = loaded(build_work, configured(workers=workers))
    sys.exit(work())


def run_alive() -> None:
    """End with 0, or where what works on this machine takes no work with 1."""
    with explaining():
        if not loaded(takes_work, configured()):
            raise ended("no worker of this machine takes what waits", STALLED)
