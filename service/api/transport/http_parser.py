"""A parser of HTTP/1.1 that refuses requests whose end is in doubt."""

from typing import Any

import h11


class StrictParser(h11.Connection):
    """A parser of requests that refuses two framings of one body, and keeps what it refused.

    A proxy that believes the other of the two would take the end of the body for a request.
    """

    error: h11.RemoteProtocolError | None = None
    method = b""

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
