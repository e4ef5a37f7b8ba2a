"""The open connections of a server, bounded in number, in all and from one address."""

import logging
import math
import time
from collections import Counter
from dataclasses import dataclass
from typing import Protocol

from service.api.transport.addresses import network_of, proxies_of
from service.api.transport.turns import Turns

_REFUSED_AT_ONCE = 32  # the most refused connections that are being told so
_LOG_EVERY = 1.0  # seconds between two lines about connections that make way
PROXY = ""  # in place of the network of connections that count for no address
_LOG = logging.getLogger("paretour")


class OpenConnection(Protocol):
    """A connection that can be closed to make way for another."""

    def abort(self) -> None:
        """Close the connection at once, even during a request."""


@dataclass(frozen=True, kw_only=True)
class ConnectionLimits:
    """The most connections, and how long one may be silent.

    Args:
        connections: The most open connections.
        share: The share of them that one address, or one IPv6 network of 64 bits, may hold.
        proxies: Addresses and networks of proxies, separated by commas, or *. They are exempt from
            the share: their connections are of many clients.
        head_seconds: Seconds until the head of a request has arrived.
    """

    connections: int = 1000
    share: float = 0.25
    proxies: str = "127.0.0.1"
    head_seconds: float = 10.0

    @property
    def of_address(self) -> int:
        """The most open connections of one address."""
        return max(math.ceil(self.share * self.connections), 1)


class Connections:
    """The open connections of a server.

    When there are too many, in all or from one address, the one of these that has been idle longest
    is closed to make way for a new one. If none is idle, the new one is refused.

    Attributes:
        turns: The turns in which these connections parse much that came at once.
    """

    def __init__(self, limits: ConnectionLimits) -> None:
        self.limits = limits
        self._is_proxy = proxies_of(limits.proxies)
        self._open: dict[OpenConnection, str] = {}  # the network that each counts for
        self._held: Counter[str] = Counter()  # by network
        self._idle: dict[OpenConnection, None] = {}  # the first has been idle longest
        self._refused: dict[OpenConnection, None] = {}
        self._next_line = 0.0
        self.turns = Turns()

    def admit(self, connection: OpenConnection, network: str) -> bool:
        """Take in a new connection of a network, and return whether there is room for it."""
        if self._has_place(network) and self._has_room():
            self._open[connection] = network
            self._held[network] += 1
            return True
        if len(self._refused) >= _REFUSED_AT_ONCE:
            next(iter(self._refused)).abort()
        self._refused[connection] = None
        return False

    def network_of_peer(self, peer: str) -> str:
        """Return the network that a peer's connection counts for, or PROXY for a proxy."""
        return PROXY if self._is_proxy(peer) else network_of(peer)

    def make_room(self) -> bool:
        """Close the connection that has been idle longest, and return whether there was one."""
        oldest = next(iter(self._idle), None)
        if oldest is not None:
            self._log("idle connections make way for new ones: %d are open", len(self._open))
            oldest.abort()
        return oldest is not None

    def set_idle(self, connection: OpenConnection, idle: bool) -> None:
        """Remember whether a connection waits for a request."""
        if not idle:
            self._idle.pop(connection, None)
        elif connection in self._open:
            self._idle.setdefault(connection)

    def remove(self, connection: OpenConnection) -> None:
        """Forget a connection that is closed."""
        network = self._open.pop(connection, None)
        if network is not None:
            self._held[network] -= 1
            if not self._held[network]:
                del self._held[network]
        self._idle.pop(connection, None)
        self._refused.pop(connection, None)

    def _has_room(self) -> bool:
        """Return whether there is room for one more, if necessary by closing an idle one."""
        if len(self._open) < self.limits.connections or self.make_room():
            return True
        self._log("a connection was refused: %d are busy", len(self._open))
        return False

    def _has_place(self, network: str) -> bool:
        """Return the same for one network, if necessary by closing one of its own."""
        if network == PROXY or self._held[network] < self.limits.of_address:
            return True
        oldest = next((each for each in self._idle if self._open[each] == network), None)
        if oldest is None:
            self._log("a connection was refused: %s has %d", network, self._held[network])
            return False
        oldest.abort()
        return True

    def _log(self, sentence: str, *values: object) -> None:
        """Write a line, unless one was written just now: clients could fill the disk."""
        now = time.monotonic()
        if now >= self._next_line:
            self._next_line = now + _LOG_EVERY
            _LOG.warning(sentence, *values)
