"""Parse request bodies into tasks: short ones in this process, others in bounded ones."""

import asyncio
import gc
import logging
import os
import resource
import signal
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from anyio import BrokenWorkerProcess, CancelScope, CapacityLimiter, to_process

from service.actor_info import ActorInfo
from service.api.turns import FairTurns
from service.errors import NoWorker, Refusal
from service.files.upload import Upload, read_upload
from service.kinds.offers import answer_offers, parse_offers
from service.kinds.parsing import check_replan as check_replan_body
from service.kinds.parsing import parse_replan, parse_task
from service.requests.limits import Limits, check_structure
from service.requests.replan.offers import OffersTask
from service.requests.replan.way import ReplanSource
from service.requests.task import Task, TaskSource
from service.requests.validation import check_depth

_SHORT = 2**17  # bytes that this process parses, in a few milliseconds
_FEW_QUOTES = 2000  # as 300 stops have, whose faults take a few milliseconds to describe
_MEDIUM = 2**20  # bytes that take a tenth of a second or two
_ATTEMPTS = 2
_STARTS = 3  # tries to start a process, each of which anyio ends after 20 seconds
_MOST_WAITING = 16  # bodies for each process
_MOST_OF_CLIENT = 8  # of these
_NICENESS = 5  # like the processes that plan: the event loop comes first
_MOST_WARNINGS = 10  # the most of one body that are logged
_LONGEST_WARNING = 500  # characters
_LOG = logging.getLogger("py.warnings")


@dataclass(frozen=True, kw_only=True)
class ParserBounds:
    """The bounds of a process that parses.

    Args:
        seconds: The time of a processor for one body, and the time that one may wait for its turn.
        memory: Bytes that a process may take beyond what it has when it is idle.
        patience: By how many more seconds of the clock it may take, where the machine has other
            work.
    """

    seconds: float = 20.0
    memory: int = 2**29 + 2**28
    patience: float = 20.0


S = TypeVar("S")
T = TypeVar("T")
_Parse = Callable[[S, Limits, Mapping[str, ActorInfo]], T]


class TaskParser:
    """Parses bodies under these limits, for these actors: short ones itself, others in a process.

    There are three processes: one for bodies of up to 1 MiB, one for longer ones, and one that
    finds offers, so that the shorter need not wait for the longer. The clients that wait for one
    have turns. Each is started for its first body, and again if it was lost. A body may take some
    seconds of a processor, and some memory. A process that takes far longer by the clock is killed.
    """

    def __init__(
        self,
        limits: Limits,
        actors: Mapping[str, ActorInfo],
        bounds: ParserBounds,
    ) -> None:
        self._limits = limits
        self._actors = dict(actors)
        self._bounds = bounds
        self._medium, self._long = (FairTurns(_MOST_WAITING, _MOST_OF_CLIENT) for _ in range(2))
        self._finding = FairTurns(_MOST_WAITING, _MOST_OF_CLIENT)
        self._processes = CapacityLimiter(3)

    async def parse(self, source: TaskSource, client: str = "") -> Task:
        """Return the task in a body of a client.

        Raises:
            Refusal: The body is malformed, too complex or over a limit, or no actor serves it.
            InvalidInstance: The cities or the map cannot be planned.
            QueueFull: Too many bodies wait to be parsed.
            NoWorker: The process that parses it does not start.
        """
        length = source.length
        short = length <= _SHORT and source.upload is None
        if short and source.body.count(b'"') <= _FEW_QUOTES:
            return parse_task(source, self._limits, self._actors)
        self._check(source.body)
        return await self._in_turn(parse_task, source, length, client)

    def check_replan(self, body: bytes) -> None:
        """Raise a refusal if a short body is not a request to replan; others are parsed later."""
        if len(body) <= _SHORT and body.count(b'"') <= _FEW_QUOTES:
            check_structure(body, self._limits)
            check_replan_body(body)
        else:
            self._check(body)

    async def replan(self, source: ReplanSource, length: int, client: str = "") -> Task:
        """Return the rest of the way of a checked request; `length` is the bytes to parse."""
        quotes = source.body.count(b'"') + source.front.task.count(b'"')
        if length <= _SHORT and quotes <= _FEW_QUOTES:
            return parse_replan(source, self._limits, self._actors)
        return await self._in_turn(parse_replan, source, length, client)

    async def offers(self, source: ReplanSource, length: int, client: str = "") -> OffersTask:
        """Return what a request for offers asks for; `length` is the bytes to parse."""
        quotes = source.body.count(b'"') + source.front.task.count(b'"')
        if length <= _SHORT and quotes <= _FEW_QUOTES:
            check_structure(source.body, self._limits)
            return parse_offers(source, self._limits, self._actors)
        self._check(source.body)
        return await self._in_turn(parse_offers, source, length, client)

    async def find_offers(self, asked: OffersTask, client: str = "") -> bytes:
        """Return the offers that are asked for, as JSON. They are always found in a process.

        Raises:
            QueueFull: Too many requests wait for theirs.
            NoWorker: The process does not start.
        """
        seconds = self._bounds.seconds
        async with self._finding.turn(client, seconds):
            return await self._parse_in_process(answer_offers, asked, seconds + asked.seconds)

    def _check(self, body: bytes) -> None:
        """Raise a refusal where a body is too complex or, unless it is long, nested too deeply.

        Such a body then need not wait until a process is started.
        """
        check_structure(body, self._limits)
        if len(body) <= _MEDIUM:
            check_depth(body)

    async def read_files(self, upload: Upload, client: str = "") -> bytes:
        """Return the request that files describe, as JSON. Files are always read in a process.

        Raises:
            Refusal: They cannot be read, or hold too much.
            QueueFull: Too many bodies wait to be parsed.
        """
        return await self._in_turn(read_upload, upload, upload.weight, client)

    async def _in_turn(self, parse: _Parse[S, T], source: S, length: int, client: str) -> T:
        """Parse a body in the process for its length, once it is the turn of its client.

        Raises:
            QueueFull: Too many bodies wait, or they take too long.
            NoWorker: The process does not start.
        """
        turns, seconds = self._medium if length <= _MEDIUM else self._long, self._bounds.seconds
        async with turns.turn(client, seconds):
            return await self._parse_in_process(parse, source, seconds)

    async def _parse_in_process(self, parse: _Parse[S, T], source: S, seconds: float) -> T:
        for _ in range(_ATTEMPTS):
            # Joining the body took a while, and so will sending it: let other requests in between.
            await asyncio.sleep(0)
            await self._start_process()
            try:
                # After that time the call is cancelled, which kills the process.
                async with asyncio.timeout(seconds + self._bounds.patience):
                    result, caught = await to_process.run_sync(
                        _parse_bounded,
                        parse,
                        source,
                        self._limits,
                        self._actors,
                        replace(self._bounds, seconds=seconds),
                        cancellable=True,
                        limiter=self._processes,
                    )
                for warning in caught:  # the process cannot log
                    _LOG.warning("%s", warning)
                if isinstance(result, Refusal):
                    raise result
                return result
            except BrokenWorkerProcess:
                continue
            except TimeoutError:
                raise NoWorker("the one that parses bodies gets too little time") from None
        raise _too_complex("without the loss of its process, and two were lost")

    async def _start_process(self) -> None:
        """Start a process unless one is idle. The body is not to blame where that takes long."""
        for _ in range(_STARTS):
            with suppress(BrokenWorkerProcess), CancelScope(shield=True):
                # Shielded, as anyio does not end a process that is left as it starts.
                await to_process.run_sync(_nothing, limiter=self._processes)
                return
        raise NoWorker("the process that parses bodies does not start")


def _nothing() -> None:
    """Do nothing, in a process that is started for it if none is idle."""


class _TimeOver(BaseException):
    """A body has taken its time of a processor."""


def _parse_bounded(
    parse: _Parse[S, T],
    source: S,
    limits: Limits,
    actors: Mapping[str, ActorInfo],
    bounds: ParserBounds,
) -> tuple[T | Refusal, list[str]]:
    """Parse a body in this process, within the bounds. Return the result and Python's warnings."""
    _bound_process(bounds.memory)
    with warnings.catch_warnings(record=True) as caught:
        result: T | Refusal
        try:
            with _time_bounded(bounds.seconds):
                result = parse(source, limits, actors)
        except MemoryError:
            result = _too_complex(f"in {bounds.memory} bytes of memory, and was not")
        except _TimeOver:
            result = _too_complex(f"within {bounds.seconds:g} s of a processor, and was not")
        except Refusal as refusal:
            # Else all that was parsed stays in memory with its frames.
            refusal.__traceback__ = refusal.__context__ = None
            result = refusal
    gc.collect()
    return result, [_warning_text(each) for each in caught[:_MOST_WARNINGS]]


@contextmanager
def _time_bounded(seconds: float) -> Iterator[None]:
    """Raise _TimeOver once this process has computed so long. Other work does not count."""

    def end(*_: object) -> None:
        raise _TimeOver

    signal.signal(signal.SIGPROF, end)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def _warning_text(caught: warnings.WarningMessage) -> str:
    text = f"{caught.category.__name__}: {caught.message}"
    return f"{Path(caught.filename).name}:{caught.lineno}: {text}"[:_LONGEST_WARNING]


def _bound_process(memory: int) -> None:
    """Bound the memory of this process and lower its priority, the first time.

    From then on garbage is collected after each body only. To look for it again and again takes
    half the time of a body of a million lists, or more, and there is little.
    """
    _, bound = resource.getrlimit(resource.RLIMIT_DATA)
    if bound == resource.RLIM_INFINITY:
        os.nice(_NICENESS)
        gc.disable()
        gc.freeze()  # the modules
        # Else pydantic stands still where it has no memory to print how it ran out of it.
        os.environ["RUST_BACKTRACE"] = "0"
        # Pages of data and stack, the sixth number (proc(5)).
        pages = int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[5])
        limit = pages * resource.getpagesize() + memory
        resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))


def _too_complex(demand: str) -> Refusal:
    return Refusal("body-too-complex", demand=f"be parsed {demand}")
