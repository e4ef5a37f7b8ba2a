"""Send the progress of a job as server-sent events, and go on after those that a client has.

A job has a state, not a history of events. So the id of an event says what a client has seen by
then: the status, and digests of the last `progress` and `compiling`. A client that connects again,
to any replica, sends this id as `Last-Event-ID`. It is sent only what differs from that: no event
twice, and always the last status.
"""

import asyncio
import re
from collections.abc import AsyncIterator, Iterator
from dataclasses import asdict, dataclass, replace
from hashlib import blake2b
from typing import Any, Self

from fastapi.sse import KEEPALIVE_COMMENT, format_sse_event
from pydantic_core import to_json

from service.jobs.engine import JobState
from service.jobs.record import Record

_HEARTBEAT = 15.0  # seconds without an event, after which a comment shows that the stream is alive
_ID = re.compile(r"([a-z]{0,9})\.([0-9a-f]{0,8})\.([0-9a-f]{0,8})")
PARAMETERS: tuple[dict[str, Any], ...] = (
    {
        "name": "Last-Event-ID",
        "in": "header",
        "description": "the id of the last event that arrived, to go on after it",
        "schema": {"type": "string"},
    },
)


@dataclass(frozen=True)
class Seen:
    """The part of a job that a client has seen: its status, and digests of events, "" if none."""

    status: str = ""
    progress: str = ""
    compiling: str = ""

    @classmethod
    def read(cls, text: str | None) -> Self:
        """Return the part that an event's id stands for; an empty one if the id is not valid."""
        found = _ID.fullmatch(text or "")
        return cls(*found.groups()) if found else cls()

    def __str__(self) -> str:
        """Return the id of an event."""
        return f"{self.status}.{self.progress}.{self.compiling}"

    def has_end(self, record: Record) -> bool:
        """Return whether a job has ended and the client knows."""
        return record.finished and self.status == record.status


async def events_after(states: AsyncIterator[JobState], seen: Seen) -> AsyncIterator[bytes]:
    """Yield the states of a job as server-sent events, until it is finished.

    Args:
        seen: What the client has seen, which is left out.
    """
    coming = asyncio.ensure_future(anext(states, None))
    try:
        while True:
            done, _ = await asyncio.wait([coming], timeout=_HEARTBEAT)
            if not done:
                yield KEEPALIVE_COMMENT
                continue
            if (state := coming.result()) is None:
                return
            coming = asyncio.ensure_future(anext(states, None))
            for name, data, after in _new(state, seen):
                seen = after
                text = to_json(data).decode()
                yield format_sse_event(event=name, data_str=text, id=str(seen))
    finally:
        coming.cancel()


def _new(state: JobState, seen: Seen) -> Iterator[tuple[str, dict[str, Any], Seen]]:
    """Yield what a client has not seen: the name and data of each event, and what is seen then."""
    # Progress first: the status may end the stream.
    for name, part in (("progress", state.progress), ("compiling", state.compiling)):
        if part is None:
            continue
        data = asdict(part)
        digest = blake2b(to_json(data), digest_size=4).hexdigest()
        if digest != getattr(seen, name):
            seen = replace(seen, **{name: digest})
            yield name, data, seen
    status = state.record.status
    if status != seen.status:
        seen = replace(seen, status=status)
        yield "status", {"id": state.record.id, "status": status}, seen
