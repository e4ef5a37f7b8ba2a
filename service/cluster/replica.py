"""The store and the engine of one replica, put together."""

from collections.abc import Callable
from functools import partial

from redis.asyncio import Redis
from redis.backoff import NoBackoff
from redis.retry import Retry

from service.cluster.celery_app import queue_at, send
from service.cluster.redis_engine import Cluster
from service.cluster.redis_store import RedisStore
from service.jobs.front_document import Rendered

_SECONDS = 2.0  # that one answer of Redis may take


def replica(
    redis_url: str,
    *,
    entries: int,
    max_age: float,
    queue: int,
    seconds: float,
    planned: Callable[[Rendered], None] = lambda _: None,
) -> tuple[RedisStore, Cluster]:
    """What all replicas at this Redis do alike."""
    # Tried once more, because a connection may be of a Redis that has been replaced.
    redis = Redis.from_url(
        redis_url, retry=Retry(NoBackoff(), 1), socket_timeout=_SECONDS, socket_keepalive=True
    )
    store = RedisStore(redis, entries=entries, max_age=max_age)
    sending = partial(send, queue_at(redis_url, seconds))
    return store, Cluster(redis, store, sending, queue=queue, seconds=seconds, planned=planned)
