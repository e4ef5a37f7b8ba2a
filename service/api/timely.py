"""Bodies that arrive in time, so that a client that trickles cannot hold a connection for ever."""

import asyncio

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.errors import Refusal


class TimelyBodies:
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
        sentence = f"the body must arrive within {self._seconds:g} s, and has not"
        refusal = Refusal(408, "body-too-slow", sentence, limit=self._seconds)
        refusal.headers["Connection"] = "close"
        return refusal
