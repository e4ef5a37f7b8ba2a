"""A parser of HTTP/1.1 that refuses requests whose end is ambiguous, and parses in small steps."""

from typing import Any

import h11

_EVENTS_AT_ONCE = 32  # mostly chunks of a body; these take a third of a millisecond
_READ_AHEAD = 2**13  # bytes of requests that wait behind an unanswered one


class StrictParser(h11.Connection):
    """A parser of requests that refuses a body whose length is given in two ways.

    A proxy that believes the other way would take the end of the body for a new request.

    Attributes:
        error: The error with which a request was refused.
        method: The method of the latest request.
        cut_off: Whether there is more to parse, which waits until begin_turn is called.
    """

    error: h11.RemoteProtocolError | None = None
    method = b""
    cut_off = False
    _left = _EVENTS_AT_ONCE
    _paused = False

    def begin_turn(self) -> None:
        """Allow the events of one more turn."""
        self._left = _EVENTS_AT_ONCE

    @property
    def has_more(self) -> bool:
        """Whether received bytes are not parsed yet."""
        return bool(self.trailing_data[0])

    @property
    def has_enough(self) -> bool:
        """Whether to read no more until the received bytes are parsed."""
        return self.cut_off or (self._paused and len(self.trailing_data[0]) > _READ_AHEAD)

    def next_event(self) -> Any:
        """Return the next event, as h11.Connection does; NEED_DATA at the end of a turn."""
        self.cut_off = not self._left
        if self.cut_off:
            return h11.NEED_DATA
        self._left -= 1
        try:
            event = super().next_event()
            if isinstance(event, h11.Request):
                self.method = event.method
                _check_framing(event)
        except h11.RemoteProtocolError as error:
            self.error = error
            raise
        self._paused = event is h11.PAUSED
        return event


def _check_framing(request: h11.Request) -> None:
    names = [name for name, _ in request.headers]
    if b"transfer-encoding" not in names:
        return
    if b"content-length" in names:
        raise h11.RemoteProtocolError("Content-Length and Transfer-Encoding exclude each other")
    if request.http_version < b"1.1":
        raise h11.RemoteProtocolError("HTTP/1.0 has no Transfer-Encoding")
