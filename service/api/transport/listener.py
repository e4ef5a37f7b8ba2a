"""The sockets to listen to, and the number of connections that descriptors allow."""

import logging
import resource
import socket

MOST_WAITING = 128  # accepted connections that wait to be served

# Files, libraries, the store, the log, connections to Redis, and those that wait or are refused.
_RESERVE = 128 + MOST_WAITING
_RESERVE_PER_WORKER = 8  # its two sockets, and pipes during its start
_FEWEST = 8


def bound_sockets(host: str, port: int) -> list[socket.socket]:
    """Return a bound socket for each address of the host, and log the addresses.

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
    """Return how many connections there may be: fewer than wanted if descriptors are few."""
    descriptors, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    if descriptors == resource.RLIM_INFINITY:
        return wanted
    left = descriptors - _RESERVE - _RESERVE_PER_WORKER * workers
    return min(wanted, max(left, _FEWEST))
