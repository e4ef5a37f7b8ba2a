"""The state of a cluster, as the script of its records tells it."""

from socket import gethostname
from time import time
from typing import Any

import redis

from service.cluster.celery_app import QUEUE
from service.cluster.script import SCRIPT


class ClusterState:
    """The workers of a cluster and its unfinished records, each under its id."""

    def __init__(self, redis_url: str) -> None:
        self._script = redis.Redis.from_url(redis_url).register_script(SCRIPT)

    def workers(self) -> set[bytes]:
        """Return the names of the workers of this machine, and of those that have a record."""
        _, _, idle = self._call("idle", gethostname(), QUEUE)
        return {*idle, *(fields[b"worker"] for fields in self._running().values())}

    def lost(self) -> int:
        """Return how many workers were lost over a record."""
        return self._call("standing")[2]

    def unfinished(self) -> dict[str, dict[bytes, bytes]]:
        """Return the fields of all unfinished records."""
        records = [dict(zip(*[iter(fields)] * 2, strict=True)) for _, fields, _ in self._records()]
        return {fields[b"id"].decode(): fields for fields in records}

    def planning(self, id: str) -> int | None:
        """Return the process that plans a front, if one does."""
        fields = self._running().get(id)
        return int(fields.get(b"process") or 0) or None if fields else None

    def searching(self) -> dict[str, int]:
        """Return the process that plans each front that has a tour already."""
        found = [id_ for id_, fields in self._running().items() if b"progress" in fields]
        return {id_: pid for id_ in found if (pid := self.planning(id_))}

    def _running(self) -> dict[str, dict[bytes, bytes]]:
        unfinished = self.unfinished().items()
        return {id_: fields for id_, fields in unfinished if fields[b"status"] == b"running"}

    def _records(self) -> Any:
        return self._call("unfinished")

    def _call(self, verb: str, *arguments: str) -> Any:
        return self._script(args=[verb, time(), *arguments])
