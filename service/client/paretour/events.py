"""Follow the progress of a job; connect again where a connection breaks."""

from typing import Any

import httpx
from paretour.bodies import Decoder
from paretour.errors import RETRY_STATUSES, refused, retry_after
from paretour.expect import parse_json, text, value_of
from paretour.requests import front_path
from paretour.server_sent_events import EventParser, ServerSentEvent
from paretour.values import FINAL_STATUSES, Progress

HEARTBEAT_SECONDS = 15.0  # between two signs of life from the service
_LONGEST_ID = 200  # characters of an event's id that is sent back
_RECONNECT_SECONDS = 1.0  # before connecting again after a connection broke


class JobEvents:
    """The events of one job: which arrived, whether the job has ended, and when to connect again.

    It opens no connection itself. Connections may break, or be refused temporarily, for `patience`
    seconds between two different events.
    """

    def __init__(self, front_id: str, timeout: float, patience: float) -> None:
        self.ended = False
        self.delay = 0.0  # seconds before the next connection
        self._front_id = front_id
        self.timeout = timeout
        self._patience = patience
        self._waited = 0.0
        self._last: ServerSentEvent | None = None
        self._parser = EventParser()

    @property
    def arguments(self) -> dict[str, Any]:
        """The keyword arguments of httpx.Client.stream for a connection."""
        return {
            "method": "GET",
            "url": f"{front_path(self._front_id)}/events",
            "headers": {
                "Accept": "text/event-stream",
                "Accept-Encoding": "identity",
                "Cache-Control": "no-store",
                **self._resuming,
            },
            "timeout": httpx.Timeout(self.timeout, read=self.timeout + HEARTBEAT_SECONDS),
        }

    @property
    def _resuming(self) -> dict[str, str]:
        """The header with which the events go on after the last, if it has an id to send."""
        id_ = "" if self._last is None else self._last.id
        sent = 0 < len(id_) <= _LONGEST_ID and id_.isascii() and id_.isprintable()
        return {"Last-Event-ID": id_} if sent else {}

    def begin(self, response: httpx.Response) -> None:
        """Begin to read a successful response.

        Raises:
            httpx.RemoteProtocolError: It is not a stream of events.
            UnexpectedAnswer: It has an encoding that was not accepted.
        """
        self._parser = EventParser()
        self._decoder = Decoder(response)
        content_type = response.headers.get("content-type", "")
        if "text/event-stream" not in content_type.partition(";")[0]:
            demand = "Content-Type must be text/event-stream"
            raise httpx.RemoteProtocolError(f"{demand}, got {content_type!r}")

    def read(self, chunk: bytes) -> list[Progress]:
        """Return the progress that a chunk of the stream reports.

        Raises:
            UnexpectedAnswer: An event is wrong, or too long.
        """
        events = [
            event for piece in self._decoder.decoded(chunk) for event in self._parser.feed(piece)
        ]
        return [progress for event in events if (progress := self._read(event)) is not None]

    def _read(self, event: ServerSentEvent) -> Progress | None:
        if event != self._last:  # a service that knows no ids repeats the last event
            self._waited, self._last = 0.0, event
        if event.type == "status":
            self.ended = parse_json(event.data, "status").read("status", text) in FINAL_STATUSES
        if event.type != "progress":
            return None
        return value_of(Progress)(parse_json(event.data, "progress").document, "progress")

    def finish(self) -> None:
        """Check that a stream did not end before the job.

        Raises:
            httpx.RemoteProtocolError: It did.
        """
        if not self.ended:
            raise httpx.RemoteProtocolError("the events ended before the job did")

    def retry_refusal(self, response: httpx.Response) -> None:
        """Set the delay that a refusal asks for.

        Raises:
            Refused: Connecting again would not help, or patience is over.
        """
        if response.status_code not in RETRY_STATUSES or not self._wait(retry_after(response)):
            raise refused(response)

    def retry_error(self, error: httpx.TransportError) -> None:
        """Set a short delay after a connection broke.

        Raises:
            httpx.TransportError: The error given, once patience is over.
        """
        if not self._wait(_RECONNECT_SECONDS):
            raise error

    def _wait(self, seconds: float) -> bool:
        """Set the delay; return whether patience is not over by then."""
        self.delay = seconds
        self._waited += seconds
        return self._waited <= self._patience
