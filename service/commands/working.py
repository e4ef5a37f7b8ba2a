"""The command that works for a cluster."""

import sys

from service.commands.configured import configured, loaded
from service.commands.exits import explaining
from service.work import build_work


def run_work(workers: int | None) -> None:
    """Plan what replicas ask for until told to stop. What is None is left to the settings."""
    with explaining():
        work = loaded(build_work, configured(workers=workers))
    sys.exit(work())
