"""The transport of Celery's messages over Redis, which drops messages of anybody else."""

import logging
from queue import Empty
from typing import Any

from kombu.transport import redis

TRANSPORT = f"{__name__}:Transport"
_SHOWN = 80  # bytes of an element in the log


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
