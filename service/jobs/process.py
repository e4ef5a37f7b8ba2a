"""A worker process, as the event loop sees it."""

import asyncio
import multiprocessing
import socket
from asyncio import StreamReader, StreamWriter
from collections.abc import AsyncIterator, Callable
from multiprocessing.context import SpawnProcess
from typing import Any

from service.jobs.messages import packed, received
from service.jobs.worker_process import Planner, run_worker

MakePlanner = Callable[[], Planner]

# A fork would copy the threads' locks but not the threads, and onnxruntime does not survive it.
_CONTEXT = multiprocessing.get_context("spawn")
_BUFFER = 2**20  # bytes


class Process:
    """A process that works, and the socket to it. When either end is gone, so is the other."""

    def __init__(self, process: SpawnProcess, reader: StreamReader, writer: StreamWriter) -> None:
        self._process = process
        self._reader = reader
        self._writer = writer

    @classmethod
    async def start(cls, make_planner: MakePlanner) -> "Process":
        """A process that loads what it needs, and will say when it has."""
        ours, theirs = socket.socketpair()
        with theirs:
            process = _CONTEXT.Process(
                target=run_worker, args=(theirs, make_planner), name="planner", daemon=True
            )
            process.start()
        return cls(process, *await asyncio.open_connection(sock=ours, limit=_BUFFER))

    @property
    def pid(self) -> int | None:
        """Its number, for logs."""
        return self._process.pid

    def send(self, message: object) -> None:
        """Tell it something; when it is gone, nothing happens."""
        self._writer.write(packed(message))

    async def messages(self) -> AsyncIterator[Any]:
        """What it says, until it is gone."""
        try:
            while True:
                yield await received(self._reader)
        except (EOFError, OSError):
            return

    def kill(self) -> None:
        """End it at once."""
        self._process.kill()

    async def gone(self) -> None:
        """Wait until it has ended, and let go of everything."""
        self._writer.close()
        await asyncio.to_thread(self._process.join)
