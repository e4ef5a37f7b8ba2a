"""The protocol of a connection: its deadlines for silent or slow clients, and its orderly end."""

import uuid
from asyncio import TimerHandle, Transport
from collections.abc import Callable
from http import HTTPStatus
from socket import IPPROTO_TCP, SO_ERROR, SOL_SOCKET, TCP_USER_TIMEOUT
from typing import Any, cast

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from service.api.responses import problem_response
from service.api.transport.connections import Connections
from service.api.transport.http_parser import StrictParser
from service.errors import Refusal

_LINGER_SECONDS = 10.0  # for which the rest of a refused body is read and dropped
_LINGER_BYTES = 2**26  # bytes of that rest: four times the longest body
_STALL_SECONDS = 30.0  # within which a client must read some of its answer
_READ_AT_ONCE = 2**14  # bytes: to parse them as tiny chunks takes 30 ms
_HALF_CLOSED_SECONDS = 0.1  # between checks whether a client that sends no more still reads
_EVERY_ANSWER = b"HTTP/1.1 "
_NO_MORE_BODY = (h11.IDLE, h11.DONE, h11.MUST_CLOSE, h11.CLOSED)


class Connection(H11Protocol):
    """A connection of uvicorn with a deadline for each request's head, and an orderly end.

    A refusal may be sent before the body is read. Closing the connection then would reset it, and
    the client would lose the answer. So the rest of the body is read and dropped first, up to a
    limit of bytes and seconds.

    A client that has closed its side of the connection may still read, so it is answered. Only
    sending something shows whether it has gone altogether. Every answer begins with `HTTP/1.1 `,
    so letters of that are sent early, one at a time.
    """

    def __init__(self, connections: Connections, **arguments: Any) -> None:
        super().__init__(**arguments)
        self.conn: StrictParser = StrictParser(h11.SERVER)
        self._connections = connections
        self._socket: Transport
        self._output: _Output
        # A connection waits for a head, or lingers, or is half closed: never two of these.
        self._timer: TimerHandle | None = None
        self._dropped = 0
        self._half_closed = False
        self.lingering = False

    def connection_made(self, transport: Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request, or refuse the connection if there are too many."""
        self._socket = transport
        transport.max_size = _READ_AT_ONCE  # type: ignore[attr-defined]  # asyncio's is 256 KiB
        opened = transport.get_extra_info("socket")
        opened.setsockopt(IPPROTO_TCP, TCP_USER_TIMEOUT, int(1000 * _STALL_SECONDS))
        self._output = _Output(transport, self)
        super().connection_made(cast(Transport, self._output))
        if self._connections.admit(self, self.client[0] if self.client else ""):
            self._note_state()
        else:
            self._send_problem(Refusal("too-many-connections"))
            self._linger()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        self._connections.remove(self)
        self._cancel_timer()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Parse what came, or drop it if it is the rest of a refused body."""
        if self.lingering or self._rest_follows:
            self._dropped += len(data)
            if self._dropped > _LINGER_BYTES:
                self.abort()
        if not self._output.is_closing():
            super().data_received(data)
            self._note_state()

    def eof_received(self) -> bool:  # type: ignore[override]
        """Keep the connection for a client that sends no more, but waits for an answer."""
        if self.lingering or not self._owes_answer:
            return False
        if not self._half_closed:
            self._half_closed = True
            self._set_timer(_HALF_CLOSED_SECONDS, self._check_half_closed, 1)
        return True

    def on_response_complete(self) -> None:
        """Begin to wait for the next request."""
        super().on_response_complete()
        self._note_state()

    def send_400_response(self, msg: str) -> None:
        """Refuse a request that is not HTTP."""
        error = self.conn.error
        refusal = Refusal("malformed-http", reason=str(error or msg))
        refusal.status = error.error_status_hint if error else refusal.status
        self._refuse(refusal)

    def shutdown(self) -> None:
        """Close the connection once its request is answered."""
        if not self.lingering:
            super().shutdown()

    def close(self) -> None:
        """Close the connection; if the client is still sending, read that first."""
        if self.conn.their_state not in _NO_MORE_BODY:
            self._linger()
        elif not self.lingering:
            self._socket.close()

    def abort(self) -> None:
        """Close the connection at once, even during a request."""
        self._connections.remove(self)
        self._socket.abort()

    @property
    def _owes_answer(self) -> bool:
        """Whether a whole request is unanswered."""
        return not (self._idle or self.cycle.more_body)

    @property
    def _idle(self) -> bool:
        """Whether all requests are answered whose heads have come."""
        return self.cycle is None or self.cycle.response_complete

    @property
    def _rest_follows(self) -> bool:
        """Whether a request was answered before its body has ended."""
        return self.conn.our_state is h11.DONE and self.conn.their_state is h11.SEND_BODY

    def _set_timer(self, seconds: float, callback: Callable[..., None], *arguments: Any) -> None:
        """Call back after these seconds, in place of any earlier callback."""
        self._cancel_timer()
        self._timer = self.loop.call_later(seconds, callback, *arguments)

    def _cancel_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _check_half_closed(self, count: int) -> None:
        """Close the connection if the client's machine has said that the client has gone.

        A letter is sent early at the 1st, 2nd, 4th, 8th check and so on: nine last 26 seconds.
        """
        if self._socket.get_extra_info("socket").getsockopt(SOL_SOCKET, SO_ERROR):
            self.abort()
            return
        if count.bit_count() == 1 and not self.cycle.response_started:
            self._output.send_ahead()
        self._set_timer(_HALF_CLOSED_SECONDS, self._check_half_closed, count + 1)

    def _unsupported_upgrade_warning(self) -> None:
        """Do not log that an upgrade is not supported: a client could fill the log."""

    def _note_state(self) -> None:
        """Start the deadline for a request's head, or end it once the head has come."""
        if self.lingering:
            return
        self._connections.set_idle(self, self._idle)
        if self._socket.is_closing():
            return
        self._output.update_reading()
        if self._half_closed:
            if not self._owes_answer:
                self._socket.close()
        elif not self._idle:
            self._dropped = 0
            self._cancel_timer()
        elif self._timer is None:
            self._set_timer(self._connections.limits.head_seconds, self._head_too_slow)

    def _head_too_slow(self) -> None:
        if self.conn.their_state is h11.IDLE and self.conn.trailing_data[0]:
            self._refuse(Refusal("head-too-slow", limit=self._connections.limits.head_seconds))
        else:
            self.close()

    def _refuse(self, refusal: Refusal) -> None:
        """Send a problem document, unless an answer has begun, and close the connection."""
        if not self._idle:
            self.cycle.disconnected = True
            self.cycle.message_event.set()
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            self._send_problem(refusal)
            self.close()
        else:
            self.abort()

    def _send_problem(self, refusal: Refusal) -> None:
        request_id = uuid.uuid4().hex
        scope = {"request_id": request_id, "root_path": self.root_path}
        response = problem_response(refusal, scope)
        headers = [*self.server_state.default_headers, *response.raw_headers]
        headers += [(b"connection", b"close"), (b"x-request-id", request_id.encode())]
        body = b"" if self.conn.method == b"HEAD" else bytes(response.body)
        reason = HTTPStatus(refusal.status).phrase.encode()
        head = h11.Response(status_code=refusal.status, headers=headers, reason=reason)
        for event in (head, h11.Data(data=body), h11.EndOfMessage()):
            self._output.write(self.conn.send(event) or b"")

    def _linger(self) -> None:
        """Send no more, and drop what comes until the client closes."""
        if self._output.is_closing():
            return
        self.lingering = True
        try:
            self._socket.write_eof()
        except OSError:  # the client reset the connection after its answer was written
            self.abort()
            return
        self._output.resume_reading()
        self._connections.set_idle(self, True)
        self._set_timer(_LINGER_SECONDS, self.abort)


class _Output:
    """The transport of a connection, which lets the connection decide when to read and close."""

    def __init__(self, transport: Transport, connection: Connection) -> None:
        self._transport = transport
        self._connection = connection
        self._reading = True
        self._ahead = 0  # bytes of the next answer that are already sent

    def __getattr__(self, name: str) -> Any:
        return getattr(self._transport, name)

    def pause_reading(self) -> None:
        """Read no more for now."""
        self._reading = False
        self.update_reading()

    def resume_reading(self) -> None:
        """Read more, unless the parser holds enough."""
        self._reading = True
        self.update_reading()

    def update_reading(self) -> None:
        """Read or pause, as was asked last, unless the parser holds enough."""
        if self._reading and not self._connection.conn.has_enough:
            self._transport.resume_reading()
        else:
            self._transport.pause_reading()

    def write(self, data: bytes) -> None:
        """Send bytes of an answer, without those that were sent early."""
        if data:
            self._transport.write(data[self._ahead :])
            self._ahead = 0

    def send_ahead(self) -> None:
        """Send the next letter of the text that every answer begins with, if one is left."""
        self._transport.write(_EVERY_ANSWER[self._ahead : self._ahead + 1])
        self._ahead = min(self._ahead + 1, len(_EVERY_ANSWER))

    def is_closing(self) -> bool:
        """Return whether nothing more can be sent."""
        return self._connection.lingering or self._transport.is_closing()

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()
