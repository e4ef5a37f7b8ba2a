"""A parser of HTTP/1.1 that refuses requests whose end is ambiguous."""

from typing import Any

import h11

_READ_AHEAD = 2**13  # bytes of requests that wait behind an unanswered one


class StrictParser(h11.Connection):
    """A parser of requests that refuses a body whose length is given in two ways.

    h11 takes such a request. A proxy that reads the other length would take the end of the body
    for a new request.

    Attributes:
        error: The error with which a request was refused.
        method: The method of the latest request.
    """

    error: h11.RemoteProtocolError | None = None
    method = b""

    @property
    def has_enough(self) -> bool:
        """Whether to read no more until a request is answered."""
        return self.their_state is h11.DONE and len(self.trailing_data[0]) > _READ_AHEAD

    def next_event(self) -> Any:
        """Return the next event, as h11.Connection does."""
        try:
            event = super().next_event()
            if isinstance(event, h11.Request):
                self.method = event.method
                _check_framing(event)
        except h11.RemoteProtocolError as error:
            self.error = error
            raise
        return event


def _check_framing(request: h11.Request) -> None:
    names = [name for name, _ in request.headers]
    if b"transfer-encoding" not in names:
        return
    if b"content-length" in names:
        raise h11.RemoteProtocolError("Content-Length and Transfer-Encoding exclude each other")
    if request.http_version < b"1.1":
        raise h11.RemoteProtocolError("HTTP/1.0 has no Transfer-Encoding")
