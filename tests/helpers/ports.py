"""Ports for servers that are told where to listen."""

import random
import socket
from contextlib import suppress


def free_port() -> int:
    """A free port of those that no other test's connection takes before the server listens.

    Connections have ports from 32768 on, as have servers that ask for any.
    """
    while True:
        port = random.randrange(20_000, 32_768)
        with suppress(OSError), socket.create_server(("127.0.0.1", port)):
            return port
