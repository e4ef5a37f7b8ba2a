"""The identity that every request carries, also where its answer is that something went wrong."""

import asyncio
import logging
import re
import uuid

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.api.exception_handlers import refusal_of
from service.errors import bug
from service.jobs.engine import Closed

ANONYMOUS = "anonymous"
_SAFE_ID = re.compile(r"[A-Za-z0-9._-]{1,64}")


class RequestIds:
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
                await refusal_of(Closed()).response(request_id)(scope, receive, send_with_id)
        except Exception:
            self._log.exception("request %s failed", request_id)
            if started:
                raise
            await bug().response(request_id)(scope, receive, send_with_id)
