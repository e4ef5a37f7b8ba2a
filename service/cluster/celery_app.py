"""Celery as it is used here: messages that say which record to work on, in a list of Redis."""

from celery import Celery
from kombu.exceptions import OperationalError

from service.cluster.records import GONE
from service.errors import StoreUnavailable

QUEUE = "paretour"
TASK = "paretour.plan"
_SPARE = 15.0  # seconds from the end of a record's time to that of its process
_MEMORY = 1_000_000  # kilobytes that a process may have grown to before a fresh one follows
_ONCE_MORE = {"max_retries": 1, "interval_start": 0}  # as a connection may be of an earlier Redis
_LOADING = 300.0  # seconds that a process may take to load, or to compile


def queue_at(redis_url: str, seconds: float) -> Celery:
    """The queue of records, none of which is worked on for more than so many seconds."""
    queue = Celery("paretour", broker=redis_url, set_as_current=False)
    queue.conf.update(
        task_default_queue=QUEUE,
        task_ignore_result=True,
        # A message is gone once its record is finished, and comes back with whoever had it.
        task_acks_late=True,
        task_reject_on_worker_lost=True,
        task_acks_on_failure=True,
        task_acks_on_timeout=False,
        worker_prefetch_multiplier=1,
        # A process that does not end in time is killed; only then may another have its message.
        task_time_limit=seconds + _SPARE,
        broker_transport_options={
            "visibility_timeout": int(seconds + 2 * _SPARE),
            "unacked_restore_interval": 5,
            "unacked_restore_throttle": 1,
            "socket_keepalive": True,
            "socket_timeout": 30.0,
            "health_check_interval": 10,
        },
        broker_connection_retry_on_startup=True,
        broker_connection_max_retries=None,
        worker_cancel_long_running_tasks_on_connection_loss=False,
        worker_enable_remote_control=False,
        worker_max_memory_per_child=_MEMORY,
        worker_proc_alive_timeout=_LOADING,
    )
    return queue


def send(queue: Celery, id: str) -> None:  # noqa: A002
    """Have a record worked on. The same may be said twice.

    Raises:
        StoreUnavailable: Redis does not answer.
    """
    try:
        queue.send_task(TASK, args=[id], task_id=id, retry_policy=_ONCE_MORE)
    except (OperationalError, *GONE) as error:
        raise StoreUnavailable from error
