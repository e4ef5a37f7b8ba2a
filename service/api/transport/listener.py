"""The sockets to listen to, and the number of connections that descriptors allow."""

import logging
import resource
import socket
from contextlib import ExitStack

# Files, libraries, the store, the log, connections to Redis, and those that are not yet admitted
# or are refused.
_RESERVE = 256
_RESERVE_PER_WORKER = 8  # its two sockets, and pipes during its start
_FEWEST = 8


def bound_sockets(host: str, port: int) -> list[socket.socket]:
    """Return a bound socket for each address of the host, and log the addresses.

    Raises:
        OSError: An address is unknown, not of this machine, or in use.
    """
    found = socket.getaddrinfo(host or None, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    with ExitStack() as opened:
        sockets: list[socket.socket] = []
        for family, kind, protocol, _, address in dict.fromkeys(found):
            # With its protocol: otherwise asyncio delays the parts of an answer.
            listening = opened.enter_context(socket.socket(family, kind, protocol))
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            if family == socket.AF_INET6:
                listening.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
            listening.bind(address)
            sockets.append(listening)
        opened.pop_all()
    for listening in sockets:
        name, number = listening.getsockname()[:2]
        shown = f"[{name}]" if ":" in name else name
        logging.getLogger("paretour").info("running on http://%s:%d", shown, number)
    return sockets


def most_connections(wanted: int, workers: int) -> int:
    """Return how many connections there may be: fewer than wanted if descriptors are few."""
    descriptors, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    if descriptors == resource.RLIM_INFINITY:
        return wanted
    left = descriptors - _RESERVE - _RESERVE_PER_WORKER * workers
    return min(wanted, max(left, _FEWEST))
