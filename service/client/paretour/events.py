"""The progress of a job, over as many connections as it takes."""

from typing import Any

import httpx
from httpx_sse import ServerSentEvent
from paretour.errors import ASK_AGAIN, pause_before_next, refusal
from paretour.values import FINAL, Progress

HEARTBEAT = 15.0  # seconds between two signs of life
_RECONNECT = 1.0  # seconds before a connection that broke is made anew


class Following:
    """What has been heard of a job, and whether and when to listen again.

    Connections may break, or be refused for now, for `patience` seconds between two news.
    """

    def __init__(self, front: str, timeout: float, patience: float) -> None:
        self.ended = False
        self.pause = 0.0  # seconds before the next connection
        self._front = front
        self._timeout = timeout
        self._patience = patience
        self._waited = 0.0

    @property
    def request(self) -> dict[str, Any]:
        """How to connect."""
        return {
            "method": "GET",
            "url": f"/front/{self._front}/events",
            "timeout": httpx.Timeout(self._timeout, read=self._timeout + HEARTBEAT),
        }

    def hear(self, event: ServerSentEvent) -> Progress | None:
        """The progress in an event, if it is of that kind."""
        self._waited = 0.0
        if event.event == "status":
            self.ended = event.json()["status"] in FINAL
        return Progress(**event.json()) if event.event == "progress" else None

    def turned_away(self, answer: httpx.Response) -> None:
        """Wait as long as a refusal asks for.

        Raises:
            Refused: it is no use, or too late.
        """
        if answer.status_code not in ASK_AGAIN or not self._wait(pause_before_next(answer)):
            raise refusal(answer)

    def broke(self, error: httpx.TransportError) -> None:
        """Wait a little after a connection broke.

        Raises:
            TransportError: that one, if it is too late.
        """
        if not self._wait(_RECONNECT):
            raise error

    def closed(self) -> None:
        """The connection is over.

        Raises:
            TransportError: and should not be yet.
        """
        if not self.ended:
            raise httpx.RemoteProtocolError("the events ended before the job did")

    def _wait(self, seconds: float) -> bool:
        self.pause = seconds
        self._waited += seconds
        return self._waited <= self._patience
