"""The sockets to listen to, how they are accepted, and how many connections there may be."""

import logging
import resource
import socket

import uvicorn

ACCEPTED_AT_ONCE = 8  # of a listening socket, in a turn of the event loop
_IN_KERNEL = 1024  # connections that wait until they are accepted
# Files, libraries, the store, the log, connections to Redis and those that are refused; and those
# that are accepted, which takes three turns until they are counted.
_RESERVE = 232 + 3 * ACCEPTED_AT_ONCE
_RESERVE_PER_WORKER = 8  # its two sockets, and pipes while it is started
_FEWEST = 8


def bound_sockets(host: str, port: int) -> list[socket.socket]:
    """Return a socket for each address of the host, and log where they will listen.

    Raises:
        OSError: An address is unknown, not of this machine, or in use.
    """
    found = socket.getaddrinfo(host or None, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    sockets: list[socket.socket] = []
    try:
        for family, kind, protocol, _, address in dict.fromkeys(found):
            listening = socket.socket(family, kind, protocol)
            sockets.append(listening)
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            if family == socket.AF_INET6:
                listening.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
            listening.bind(address)
    except OSError:
        for listening in sockets:
            listening.close()
        raise
    for listening in sockets:
        name, number = listening.getsockname()[:2]
        shown = f"[{name}]" if ":" in name else name
        logging.getLogger("paretour").info("running on http://%s:%d", shown, number)
    return sockets


def most_connections(wanted: int, workers: int) -> int:
    """Return how many connections there may be: no more than descriptors are left for."""
    descriptors, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    if descriptors == resource.RLIM_INFINITY:
        return wanted
    left = descriptors - _RESERVE - _RESERVE_PER_WORKER * workers
    return min(wanted, max(left, _FEWEST))


class Server(uvicorn.Server):
    """A server of uvicorn that accepts few connections at a time, while many may wait."""

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start the application, then accept connections of these sockets."""
        await super().startup(sockets)
        for listening in sockets or ():
            listening.listen(_IN_KERNEL)  # asyncio has as many wait as it accepts at a time
