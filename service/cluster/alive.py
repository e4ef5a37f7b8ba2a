"""Whether the worker of this machine takes work, as whoever watches over it may ask.

Its processes may live on while the one that gives out messages is stalled. Then some of them have
nothing to do although messages wait, which otherwise lasts no longer than to hand one over.
"""

from socket import gethostname
from time import monotonic, sleep, time

from service.cluster.celery_app import QUEUE
from service.cluster.records import GONE, LEASE
from service.cluster.worker_store import script_at

_SECONDS = LEASE + 1  # until a process that was lost counts as one no more
_PAUSE = 0.25  # seconds between two looks


def takes_work(redis_url: str) -> bool:
    """Whether it does, or would: where Redis does not answer, that is no fault of the worker."""
    look = script_at(redis_url)
    deadline = monotonic() + _SECONDS
    try:
        here, waiting, idle = look(args=["idle", time(), gethostname(), QUEUE])
        while here and waiting and idle and monotonic() < deadline:
            sleep(_PAUSE)
            here, waiting, still = look(args=["idle", time(), gethostname(), QUEUE])
            idle = set(idle).intersection(still)
    except GONE:
        return True
    return bool(here) and not (waiting and idle)
