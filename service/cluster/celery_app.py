"""The Celery application: its messages are ids of records to plan, in a list of Redis."""

import ssl

from celery import Celery
from kombu.exceptions import OperationalError
from redis.exceptions import ResponseError

from service.cluster.records import UNAVAILABLE
from service.cluster.transport import TRANSPORT
from service.errors import StoreUnavailable

QUEUE = "paretour"
TASK = "paretour.plan"
_SPARE = 15.0  # seconds from a record's time limit until its process is killed
_MEMORY = 1_000_000  # kilobytes that a process may have grown to before a fresh one follows
_ONCE_MORE = {
    "max_retries": 1,
    "interval_start": 0,
}  # as the connection may be to a Redis that was restarted
_LOADING = 300.0  # seconds that a process may take to load, or to compile


def make_celery(redis_url: str, seconds: float) -> Celery:
    """Return the application at this Redis, whose tasks are killed soon after their time limit."""
    celery = Celery("paretour", broker=redis_url, set_as_current=False)
    celery.conf.broker_transport = TRANSPORT
    if redis_url.startswith("rediss:"):
        # As kombu does for its own transport. Options in the address take precedence.
        celery.conf.broker_use_ssl = {"ssl_cert_reqs": ssl.CERT_REQUIRED}
    celery.conf.update(
        task_default_queue=QUEUE,
        task_ignore_result=True,
        # A message is removed once its record is finished, and comes back if its worker is lost.
        task_acks_late=True,
        task_reject_on_worker_lost=True,
        task_acks_on_failure=True,
        task_acks_on_timeout=False,
        worker_prefetch_multiplier=1,
        # A process that takes too long is killed; only then is its message sent to another.
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
        # Redis refuses writes where it is full; the worker connects anew until there is room.
        broker_channel_error_retry=True,
        worker_cancel_long_running_tasks_on_connection_loss=False,
        worker_enable_remote_control=False,
        worker_max_memory_per_child=_MEMORY,
        worker_proc_alive_timeout=_LOADING,
    )
    return celery


def send_record(celery: Celery, id: str) -> None:  # noqa: A002
    """Send the id of a record to plan. The same id may be sent twice.

    Raises:
        StoreUnavailable: Redis does not answer, or the key of the messages holds something else.
    """
    try:
        celery.send_task(TASK, args=[id], task_id=id, retry_policy=_ONCE_MORE)
    except (OperationalError, ResponseError, *UNAVAILABLE) as error:
        raise StoreUnavailable from error
