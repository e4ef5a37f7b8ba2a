"""The Celery application: its messages are ids of records to plan, in a list of Redis.

Its transport drops what others have put into that list.
"""

import logging
import ssl
from queue import Empty
from typing import Any

from celery import Celery
from kombu.exceptions import OperationalError
from kombu.transport import redis
from redis.exceptions import ResponseError

from service.cluster.script import UNAVAILABLE
from service.errors import StoreUnavailable

QUEUE = "paretour"
TASK = "paretour.plan"
_SHOWN = 80  # bytes of a foreign element in the log
_SPARE = 30.0  # seconds from a record's time limit until its message is sent to another worker
# The connection may be to a Redis that was restarted.
_ONCE_MORE = {"max_retries": 1, "interval_start": 0}


def make_celery(redis_url: str, seconds: float) -> Celery:
    """Return the application at this Redis, for records with a time limit in seconds."""
    celery = Celery("paretour", broker=redis_url, set_as_current=False)
    celery.conf.broker_transport = f"{__name__}:Transport"
    if redis_url.startswith("rediss:"):
        # As kombu does for its own transport. Options in the address take precedence.
        celery.conf.broker_use_ssl = {"ssl_cert_reqs": ssl.CERT_REQUIRED}
    celery.conf.update(
        task_default_queue=QUEUE,
        task_ignore_result=True,
        # A message is removed once its record is finished, and comes back if its worker is lost.
        task_acks_late=True,
        task_acks_on_failure=True,
        worker_prefetch_multiplier=1,
        broker_transport_options={
            "visibility_timeout": int(seconds + _SPARE),
            "unacked_restore_interval": 5,
            "unacked_restore_throttle": 1,
            "socket_keepalive": True,
            "socket_timeout": 30.0,
            "health_check_interval": 10,
        },
        broker_connection_retry_on_startup=True,
        broker_connection_max_retries=None,
        # Redis refuses writes where it is full; the worker connects again until there is room.
        broker_channel_error_retry=True,
        worker_cancel_long_running_tasks_on_connection_loss=False,
        worker_enable_remote_control=False,
    )
    return celery


def send_record(celery: Celery, id: str) -> None:
    """Send the id of a record to plan. The same id may be sent twice.

    Raises:
        StoreUnavailable: Redis does not answer, or the key of the messages holds something else.
    """
    try:
        celery.send_task(TASK, args=[id], task_id=id, retry_policy=_ONCE_MORE)
    except (OperationalError, ResponseError, *UNAVAILABLE) as error:
        raise StoreUnavailable from error


class Channel(redis.Channel):
    """A channel that survives an element of its list that is not JSON."""

    def _brpop_read(self, **options: Any) -> Any:
        try:
            return super()._brpop_read(**options)  # type: ignore[no-untyped-call]
        except (RecursionError, ValueError) as error:
            # The element is off the list already.
            _log_dropped(getattr(error, "doc", getattr(error, "object", b"")), error)
            raise Empty from None


class Transport(redis.Transport):
    """A transport that passes on messages of the service alone."""

    Channel = Channel

    def _deliver(self, message: Any, queue: str) -> None:
        try:
            _check(message)
        except (LookupError, TypeError, ValueError) as error:
            _log_dropped(str(message), error)
        else:
            super()._deliver(message, queue)  # type: ignore[no-untyped-call]


def _check(message: Any) -> None:
    """Raise an error of Python if a message lacks what Celery reads before it can refuse it."""
    headers, properties, body = message["headers"], message["properties"], message["body"]
    delivery = properties["delivery_info"]
    texts = (headers["task"], headers["id"], properties["delivery_tag"], body)
    routes = (delivery["exchange"], delivery["routing_key"])
    for text in (*texts, *routes, message["content-type"], message["content-encoding"]):
        if not isinstance(text, str):
            raise TypeError(f"must be a text, got {type(text).__name__}")


def _log_dropped(element: str | bytes, error: Exception) -> None:
    logging.getLogger("paretour").warning(
        "an element of the list of messages is not the service's and is dropped: %r (%s: %s)",
        element[:_SHOWN],
        type(error).__name__,
        str(error)[:_SHOWN],
    )
