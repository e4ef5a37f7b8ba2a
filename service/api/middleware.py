"""Middleware: security headers, request ids, the request log, and a time limit for bodies."""

import asyncio
import logging
import re
import time
import uuid
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.api.responses import problem_response
from service.errors import Refusal, ShuttingDown

# Everything comes from the service itself; maps of robots are drawn into images (data:).
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_HEADERS = {
    "Content-Security-Policy": _POLICY,
    "Cross-Origin-Opener-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}


class SecurityHeadersMiddleware:
    """Tells browsers to load nothing but what the service serves, and to embed none of it."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(_HEADERS)
            await send(message)

        await self._app(scope, receive, send_with_headers)


ANONYMOUS = "anonymous"
_SAFE_ID = re.compile(r"[A-Za-z0-9._-]{1,64}")


class RequestIdMiddleware:
    """Gives each request an identity and turns a bug into a problem document that carries it.

    Until it has shown a key, its caller is anonymous.
    The caller's own X-Request-ID is kept where it is short and plain enough to log.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._log = logging.getLogger("paretour")

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        given = Headers(scope=scope).get("x-request-id", "")
        request_id = given if _SAFE_ID.fullmatch(given) else uuid.uuid4().hex
        scope["request_id"] = request_id
        scope["caller"] = ANONYMOUS
        started = False

        async def send_with_id(message: Message) -> None:
            nonlocal started
            if message["type"] == "http.response.start":
                started = True
                MutableHeaders(scope=message)["X-Request-ID"] = request_id
            await send(message)

        try:
            await self._app(scope, receive, send_with_id)
        except asyncio.CancelledError:
            # Only a server that shuts down cancels; nobody else waits for this task.
            if not started:
                await problem_response(ShuttingDown(), request_id)(scope, receive, send_with_id)
        except Exception:
            self._log.exception("request %s failed", request_id)
            if started:
                raise
            await problem_response(Refusal("internal-error"), request_id)(
                scope, receive, send_with_id
            )


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


class RequestLogMiddleware:
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


class BodyTimeoutMiddleware:
    """Refuses a body of which the last byte comes too late."""

    def __init__(self, app: ASGIApp, seconds: float) -> None:
        self._app = app
        self._seconds = seconds

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        deadline = asyncio.get_running_loop().time() + self._seconds
        whole = False

        async def receive_in_time() -> Message:
            nonlocal whole
            if whole:  # what comes now is that the client has gone away, whenever it does
                return await receive()
            try:
                async with asyncio.timeout_at(deadline):
                    message = await receive()
            except TimeoutError:
                raise self._late() from None
            whole = not message.get("more_body", False)
            return message

        await self._app(scope, receive_in_time, send)

    def _late(self) -> Refusal:
        return Refusal("body-too-slow", limit=self._seconds, headers={"Connection": "close"})
