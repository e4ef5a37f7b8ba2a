"""Listening sockets, which accept a few connections at a time, also when descriptors run out."""

import errno
import logging
import resource
import socket
import time
from collections.abc import Callable
from typing import Any

ACCEPTED_AT_ONCE = 16  # more could take every descriptor before the first of them is counted
_WAITING = 1024  # connections that the kernel keeps until they are accepted
_PAUSE = 0.9  # asyncio tries again after a second
_EXHAUSTED = (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM)

# Files, libraries, the store, the log, connections to Redis, and those being accepted or refused.
_RESERVE = 128
_RESERVE_PER_WORKER = 8  # its socket, and pipes while it is started
_FEWEST = 8


class ListeningSocket(socket.socket):
    """A socket that asyncio can accept connections of without filling the log.

    When descriptors run out, asyncio logs it, and in Python 3.11 goes on to accept, and to log it,
    as often as it would have accepted.

    Args:
        exhausted: Called when descriptors have run out, to close some.
    """

    def __init__(self, *args: Any, exhausted: Callable[[], object], **more: Any) -> None:
        super().__init__(*args, **more)
        self._exhausted = exhausted
        self._paused_until = 0.0

    def listen(self, _backlog: int = _WAITING, /) -> None:
        """Begin to listen; asyncio's backlog is how many it accepts at once."""
        super().listen(_WAITING)

    def accept(self) -> tuple[socket.socket, Any]:
        """Accept a connection; where that has just failed for want of descriptors, none."""
        if time.monotonic() < self._paused_until:
            raise BlockingIOError
        try:
            return super().accept()
        except OSError as error:
            if error.errno in _EXHAUSTED:
                self._paused_until = time.monotonic() + _PAUSE
                self._exhausted()
            raise


def bound_sockets(host: str, port: int, exhausted: Callable[[], object]) -> list[socket.socket]:
    """Return a socket for each address of the host, and log where they will listen.

    Raises:
        OSError: An address is unknown, not of this machine, or in use.
    """
    found = socket.getaddrinfo(host or None, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    sockets: list[ListeningSocket] = []
    try:
        for family, kind, protocol, _, address in dict.fromkeys(found):
            listening = ListeningSocket(family, kind, protocol, exhausted=exhausted)
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
    return [*sockets]


def most_connections(wanted: int, workers: int) -> int:
    """Return how many connections there may be: no more than descriptors are left for."""
    descriptors, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    if descriptors == resource.RLIM_INFINITY:
        return wanted
    left = descriptors - _RESERVE - _RESERVE_PER_WORKER * workers
    return min(wanted, max(left, _FEWEST))
