"""The open connections of a server, bounded in number, in all and from one address."""

import logging
import math
import time
from collections import Counter
from dataclasses import dataclass
from functools import lru_cache
from ipaddress import IPv6Address, ip_address, ip_network
from typing import Protocol

from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

_REFUSED_AT_ONCE = 32  # the most refused connections whose clients still read the refusal
_LOG_EVERY = 1.0  # seconds between two lines about connections that make way
_PROXY = ""  # in place of the network of connections that count for no address
_LOG = logging.getLogger("paretour")


@lru_cache(maxsize=1024)  # each request calls it several times
def network_of(address: str) -> str:
    """Return an IPv4 address as it is, and for IPv6 the /64 network, which one client has.

    >>> network_of("192.0.2.7"), network_of("2001:db8:1:2:3:4:5:6")
    ('192.0.2.7', '2001:db8:1:2::/64')
    """
    try:
        parsed = ip_address(address)
    except ValueError:  # text of a proxy, which need not be an address
        return address[:64]
    if not isinstance(parsed, IPv6Address):
        return address
    if parsed.ipv4_mapped is not None:
        return str(parsed.ipv4_mapped)
    return str(ip_network((parsed.packed, 64), strict=False))


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
    """

    def __init__(self, limits: ConnectionLimits) -> None:
        self.limits = limits
        # uvicorn tells proxies from clients; the middleware itself is not used.
        trusted = ProxyHeadersMiddleware(None, limits.proxies)  # type: ignore[arg-type]
        self._proxies = trusted.trusted_hosts
        self._open: dict[OpenConnection, str] = {}  # the network that each counts for
        self._held: Counter[str] = Counter()  # by network
        self._idle: dict[OpenConnection, None] = {}  # the first has been idle longest
        self._refused: dict[OpenConnection, None] = {}
        self._next_line = 0.0

    def admit(self, connection: OpenConnection, peer: str) -> bool:
        """Take in a new connection from an address, and return whether there is room for it."""
        network = _PROXY if peer in self._proxies else network_of(peer)
        if self._has_room(network):
            self._open[connection] = network
            self._held[network] += 1
            return True
        if len(self._refused) >= _REFUSED_AT_ONCE:
            next(iter(self._refused)).abort()
        self._refused[connection] = None
        return False

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

    def _has_room(self, network: str) -> bool:
        """Return whether there is room for one more, if necessary by closing an idle one."""
        crowded = network != _PROXY and self._held[network] >= self.limits.of_address
        if not crowded and len(self._open) < self.limits.connections:
            return True
        own = (each for each in self._idle if not crowded or self._open[each] == network)
        oldest = next(own, None)
        if oldest is None:
            reason = f"{network} has {self._held[network]}" if crowded else "all are busy"
            self._log(f"a connection was refused: {reason}")
            return False
        self._log(f"idle connections make way for new ones: {len(self._open)} are open")
        oldest.abort()
        return True

    def _log(self, sentence: str) -> None:
        """Write a line, unless one was written just now: clients could fill the disk."""
        now = time.monotonic()
        if now >= self._next_line:
            self._next_line = now + _LOG_EVERY
            _LOG.warning(sentence)
