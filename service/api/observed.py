"""What happened to each request, told to whoever counts and to the log."""

import logging
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

UNMATCHED = "unmatched"
_GONE = 499  # in the log and the metrics alone: the client went away before its body had ended


@dataclass(frozen=True, kw_only=True)
class Answered:
    """A request and its answer. The path is the template that it matched."""

    request_id: str
    caller: str
    method: str
    path: str
    status: int
    seconds: float


Observer = Callable[[Answered], None]


class ObservedRequests:
    """Tells the observers of every request, once its answer has ended."""

    def __init__(self, app: ASGIApp, observers: Iterable[Observer]) -> None:
        self._app = app
        self._observers = tuple(observers)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        began = time.perf_counter()
        status = 500  # what an answer that never began becomes

        async def send_seen(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
            await send(message)

        try:
            await self._app(scope, receive, send_seen)
        except ClientDisconnect:
            status = _GONE  # and there is nobody left to answer
        finally:
            answered = Answered(
                request_id=scope["request_id"],
                caller=scope["caller"],
                method=scope["method"],
                path=getattr(scope.get("route"), "path", UNMATCHED),
                status=status,
                seconds=time.perf_counter() - began,
            )
            for observer in self._observers:
                observer(answered)


def log_request(answered: Answered) -> None:
    """One line for each request."""
    logging.getLogger("paretour.requests").info("request", extra=vars(answered))
