"""Accept connections, and serve a few in each turn of the event loop, one address after another."""

import asyncio
import logging
from collections import deque
from collections.abc import Callable
from socket import IPPROTO_TCP, TCP_NODELAY, socket
from typing import Any

import uvicorn

from service.api.transport.connections import PROXY, Connections
from service.api.transport.listener import MOST_WAITING

_SERVED_AT_ONCE = 4  # new connections in a turn of the event loop: more would hold up all others
_ACCEPTED_AT_ONCE = 64  # connections of a listening socket accepted in a turn
_IN_KERNEL = 1024  # connections that wait until they are accepted
_PAUSE = 1.0  # seconds after which a failed accept is tried again
_NONE_WAITS = (BlockingIOError, InterruptedError, ConnectionAbortedError)
_LOG = logging.getLogger("paretour")

MakeProtocol = Callable[[], asyncio.Protocol]


class WaitingConnections:
    """Accepted connections that are not yet served; the address that waits longest is next.

    Args:
        most: How many may wait. Beyond that the address with the most loses its newest.
    """

    def __init__(self, most: int = MOST_WAITING) -> None:
        self._most = most
        self._lines: dict[str, deque[socket]] = {}  # by network, in the order of their turns

    def __len__(self) -> int:
        """Return how many wait."""
        return sum(map(len, self._lines.values()))

    def make_room(self) -> bool:
        """Return whether one more may wait; where too many do, close one of the longest line.

        The line of proxies is not cut: their connections are of many clients.
        """
        if len(self) < self._most:
            return True
        longest = max(self._lines, key=lambda network: len(self._lines[network]))
        if longest == PROXY:
            return False
        self._lines[longest].pop().close()
        if not self._lines[longest]:
            del self._lines[longest]
        return True

    def append(self, network: str, connection: socket) -> None:
        """Add a connection behind those of the same network."""
        self._lines.setdefault(network, deque()).append(connection)

    def take(self) -> socket:
        """Remove the next connection and return it; there must be one."""
        network = next(iter(self._lines))
        line = self._lines.pop(network)
        connection = line.popleft()
        if line:
            self._lines[network] = line
        return connection

    def close(self) -> None:
        """Close all."""
        while self._lines:
            self.take().close()


class Acceptor:
    """Accepts the connections of listening sockets, so that a crowd at one address delays no other.

    They are accepted as they come, which costs little, and served by address in turn. If accepting
    fails, mostly for lack of descriptors, an idle connection is closed and all wait for a while.
    """

    def __init__(self, connections: Connections) -> None:
        self._connections = connections
        self._waiting = WaitingConnections()
        self._sockets: list[socket] = []
        self._begun: set[asyncio.Task[Any]] = set()
        self._scheduled = False
        self._make_protocol: MakeProtocol

    def start(self, sockets: list[socket], make_protocol: MakeProtocol) -> None:
        """Listen to bound sockets, and make a protocol for each connection that is served."""
        self._sockets, self._make_protocol = sockets, make_protocol
        for listening in sockets:
            listening.setblocking(False)
            # Its connections inherit this: without it an answer's body waits 40 ms for the client's
            # acknowledgement of the head, which asyncio prevents for sockets that it makes itself.
            listening.setsockopt(IPPROTO_TCP, TCP_NODELAY, 1)
            listening.listen(_IN_KERNEL)
            self._watch(listening)

    def close(self) -> None:
        """Stop accepting, and close the sockets and the waiting connections."""
        loop = asyncio.get_running_loop()
        for listening in self._sockets:
            loop.remove_reader(listening)
            listening.close()
        self._sockets = []
        self._waiting.close()

    def _watch(self, listening: socket) -> None:
        if listening in self._sockets:
            asyncio.get_running_loop().add_reader(listening, self._accept, listening)

    def _accept(self, listening: socket) -> None:
        try:
            for _ in range(_ACCEPTED_AT_ONCE):
                if not self._waiting.make_room():
                    break
                connection, peer = listening.accept()
                self._waiting.append(self._connections.network_of_peer(peer[0]), connection)
        except _NONE_WAITS:
            pass
        except OSError as error:
            self._pause(listening, error)
        self._serve_soon()

    def _pause(self, listening: socket, error: OSError) -> None:
        _LOG.warning("no connection can be accepted for %g s: %s", _PAUSE, error)
        loop = asyncio.get_running_loop()
        loop.remove_reader(listening)
        loop.call_later(_PAUSE, self._watch, listening)
        self._connections.make_room()

    def _serve_soon(self) -> None:
        if len(self._waiting) and not self._scheduled:
            self._scheduled = True
            asyncio.get_running_loop().call_soon(self._serve)

    def _serve(self) -> None:
        """Serve the next few, and leave the others to the next turns of the event loop."""
        self._scheduled = False
        loop = asyncio.get_running_loop()
        for _ in range(min(_SERVED_AT_ONCE, len(self._waiting))):
            serving = loop.connect_accepted_socket(self._make_protocol, self._waiting.take())
            task = loop.create_task(serving)
            self._begun.add(task)
            task.add_done_callback(self._begun.discard)
        self._serve_soon()


class FairServer(uvicorn.Server):
    """A server of uvicorn whose connections an Acceptor accepts."""

    def __init__(self, config: uvicorn.Config, connections: Connections) -> None:
        super().__init__(config)
        self._acceptor = Acceptor(connections)

    async def startup(self, sockets: list[socket] | None = None) -> None:
        """Start the application, then accept connections of these sockets."""
        await super().startup(sockets=[])
        self._acceptor.start(sockets or [], self._protocol)

    async def shutdown(self, sockets: list[socket] | None = None) -> None:  # noqa: ARG002
        """Accept no more connections, end the open ones, and close the application."""
        self._acceptor.close()
        await super().shutdown(sockets=[])

    def _protocol(self) -> asyncio.Protocol:
        make: Any = self.config.http_protocol_class
        protocol: asyncio.Protocol = make(
            config=self.config, server_state=self.server_state, app_state=self.lifespan.state
        )
        return protocol
