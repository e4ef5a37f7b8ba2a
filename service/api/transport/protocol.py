"""The protocol of a connection: its deadlines for silent or slow clients, and its orderly end."""

import asyncio
import socket
import uuid
from asyncio import TimerHandle, Transport
from http import HTTPStatus
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
_READ_AT_ONCE = 2**16  # bytes
_HALF_CLOSED_SECONDS = 0.1  # between checks whether a client that sends no more still reads
_EVERY_ANSWER = b"HTTP/1.1 "
_NO_MORE_BODY = (h11.IDLE, h11.DONE, h11.MUST_CLOSE, h11.CLOSED)


class Connection(H11Protocol):
    """A connection of uvicorn with a deadline for each request's head, and an orderly end.

    A refusal may be sent before the body is read. Closing the connection then would reset it, and
    the client would lose the answer. So the rest of the body is read and dropped first, up to a
    limit of bytes and seconds.

    A client may send many requests, or many chunks of a body, at once. Each turn of the event loop
    parses a few of them, and no more is read meanwhile.

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
        self._head_timer: TimerHandle | None = None
        self._linger_timer: TimerHandle | None = None
        self._stall_timer: TimerHandle | None = None
        self._half_closed_timer: TimerHandle | None = None
        self._dropped = 0
        self._network = ""
        self._waits_for_turn = False
        self.half_closed = False
        self.lingering = False

    def connection_made(self, transport: Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request, or refuse the connection if there are too many."""
        self._socket = transport
        transport.max_size = _READ_AT_ONCE  # type: ignore[attr-defined]  # asyncio's is 256 KiB
        self._output = _Output(transport, self)
        super().connection_made(cast(Transport, self._output))
        peer = self.client[0] if self.client else ""
        self._network = self._connections.network_of_peer(peer)
        if self._connections.admit(self, self._network):
            self._note_idle()
        else:
            self._send_problem(Refusal("too-many-connections"))
            self._linger()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        self._connections.remove(self)
        timers = (self._head_timer, self._linger_timer, self._stall_timer, self._half_closed_timer)
        for timer in timers:
            if timer is not None:
                timer.cancel()
        self._unset_keepalive_if_required()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Parse what came, or drop it if it is the rest of a refused body."""
        if self.lingering or self._rest_follows:
            self._dropped += len(data)
            if self._dropped > _LINGER_BYTES:
                self.abort()
        if not self.lingering and not self._socket.is_closing():
            super().data_received(data)
            self._note_idle()

    def eof_received(self) -> bool:  # type: ignore[override]
        """Keep the connection for a client that sends no more, but waits for an answer."""
        if self.lingering or not self._owes_answer:
            return False
        if not self.half_closed:
            self.half_closed = True
            self._half_closed_timer = self.loop.call_later(
                _HALF_CLOSED_SECONDS, self._check_half_closed
            )
        return True

    def handle_events(self) -> None:
        """Parse a little of what came: at once, or if more waits, in its network's turn."""
        if self._waits_for_turn:
            return
        self.conn.begin_turn()
        super().handle_events()
        if self.conn.cut_off:
            self._wait_for_turn()
        self._output.update_reading()

    def on_response_complete(self) -> None:
        """Begin to wait for the next request; one that is already here waits for its turn."""
        if self.conn.has_more:
            self._wait_for_turn()
        super().on_response_complete()
        self._note_idle()
        self._close_if_answered()

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

    def pause_writing(self) -> None:
        """Give the client a while to read some of its answer."""
        super().pause_writing()
        self._expect_reading()

    def resume_writing(self) -> None:
        """Go on: the client has read most of its answer."""
        super().resume_writing()
        if self._stall_timer is not None and not self._socket.is_closing():
            self._stall_timer.cancel()
            self._stall_timer = None

    def close(self) -> None:
        """Close the connection; if the client is still sending, read that first."""
        if self.lingering or self._socket.is_closing():
            return
        if self.conn.their_state in _NO_MORE_BODY:
            self._socket.close()
            self._expect_reading()
        else:
            self._linger()

    def abort(self) -> None:
        """Close the connection at once, even during a request."""
        self._connections.remove(self)
        self._socket.abort()

    @property
    def _owes_answer(self) -> bool:
        """Whether a whole request is unanswered, or may be among the bytes not parsed yet."""
        answering = self.cycle is not None and not self.cycle.response_complete
        return self._waits_for_turn or (answering and not self.cycle.more_body)

    def _wait_for_turn(self) -> None:
        if not self._waits_for_turn:
            self._waits_for_turn = True
            self._connections.turns.wait(self._network, self._take_turn)

    def _take_turn(self) -> None:
        self._waits_for_turn = False
        if not self.lingering and not self._socket.is_closing():
            self.handle_events()
            self._note_idle()
            self._close_if_answered()

    def _close_if_answered(self) -> None:
        """Close the connection of a client that sends no more, once it has all its answers."""
        if self.half_closed and not self._owes_answer:
            self._socket.close()

    def _check_half_closed(self, count: int = 1) -> None:
        """Close the connection if the client's machine has said that the client has gone.

        A letter is sent early at the 1st, 2nd, 4th, 8th check and so on: nine last 26 seconds.
        """
        if self._socket.get_extra_info("socket").getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
            self.abort()
            return
        if count.bit_count() == 1 and not self.cycle.response_started:
            self._output.send_ahead()
        self._half_closed_timer = self.loop.call_later(
            _HALF_CLOSED_SECONDS, self._check_half_closed, count + 1
        )

    @property
    def _rest_follows(self) -> bool:
        """Whether a request is being answered before its body has ended."""
        return self.conn.our_state is h11.DONE and self.conn.their_state is h11.SEND_BODY

    def _unsupported_upgrade_warning(self) -> None:
        """Do not log that an upgrade is not supported: a client could fill the log."""

    def _note_idle(self) -> None:
        """Start the deadline for a request's head, or end it once the head has come."""
        idle = self.cycle is None or self.cycle.response_complete
        self._connections.set_idle(self, idle)
        if not idle:
            self._dropped = 0
            if self._head_timer is not None:
                self._head_timer.cancel()
                self._head_timer = None
        elif self._head_timer is None and not self._socket.is_closing():
            seconds = self._connections.limits.head_seconds
            self._head_timer = self.loop.call_later(seconds, self._head_too_slow)

    def _head_too_slow(self) -> None:
        if self.conn.their_state is h11.IDLE and self.conn.trailing_data[0]:
            self._refuse(Refusal("head-too-slow", limit=self._connections.limits.head_seconds))
        else:
            self.close()

    def _refuse(self, refusal: Refusal) -> None:
        """Send a problem document, unless an answer has begun, and close the connection."""
        if self.cycle is not None and not self.cycle.response_complete:
            self.cycle.disconnected = True
            self.cycle.message_event.set()
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            self._send_problem(refusal)
            self.close()
        else:
            self.abort()

    def _send_problem(self, refusal: Refusal) -> None:
        request_id = uuid.uuid4().hex
        response = problem_response(refusal, request_id)
        headers = [*self.server_state.default_headers, *response.raw_headers]
        headers += [(b"connection", b"close"), (b"x-request-id", request_id.encode())]
        body = b"" if self.conn.method == b"HEAD" else bytes(response.body)
        reason = HTTPStatus(refusal.status).phrase.encode()
        head = h11.Response(status_code=refusal.status, headers=headers, reason=reason)
        for event in (head, h11.Data(data=body), h11.EndOfMessage()):
            self._output.write(self.conn.send(event) or b"")

    def _linger(self) -> None:
        """Send no more, and drop what comes until the client closes."""
        if self.lingering or self._socket.is_closing():
            return
        self.lingering = True
        self._unset_keepalive_if_required()
        try:
            self._socket.write_eof()
        except OSError:  # the client reset the connection after its answer was written
            self.abort()
            return
        self.flow.resume_reading()
        self._connections.set_idle(self, True)
        self._linger_timer = self.loop.call_later(_LINGER_SECONDS, self.abort)

    def _expect_reading(self) -> None:
        """Close the connection if the client has read nothing of its answer for a while."""
        if self._stall_timer is None:
            unsent = self._socket.get_write_buffer_size()
            self._stall_timer = self.loop.call_later(_STALL_SECONDS, self._check_reading, unsent)

    def _check_reading(self, unsent: int) -> None:
        self._stall_timer = None
        if self._socket.get_write_buffer_size() < unsent:
            self._expect_reading()
        else:
            self.abort()


class _Output:
    """The transport of a connection, which lets the connection decide when to read and close."""

    def __init__(self, transport: asyncio.Transport, connection: Connection) -> None:
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
        """Read more, once the received bytes are parsed."""
        self._reading = True
        self.update_reading()

    def update_reading(self) -> None:
        """Read or pause, as was asked last, unless the parser holds enough."""
        if not self._reading or self._connection.conn.has_enough:
            self._transport.pause_reading()
        elif not self._connection.half_closed:
            self._transport.resume_reading()

    def write(self, data: bytes) -> None:
        """Send bytes of an answer, without those that were sent early."""
        if data:
            self._transport.write(data[self._ahead :])
            self._ahead = 0

    def send_ahead(self) -> None:
        """Send the next letter with which every answer begins, if one is left."""
        self._transport.write(_EVERY_ANSWER[self._ahead : self._ahead + 1])
        self._ahead = min(self._ahead + 1, len(_EVERY_ANSWER))

    def is_closing(self) -> bool:
        """Return whether nothing more can be sent."""
        return self._connection.lingering or self._transport.is_closing()

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()
