"""Logs as lines of JSON, or on a terminal as plain lines; and traces for OpenTelemetry."""

import asyncio
import logging
import logging.config
import sys
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager, contextmanager, suppress
from threading import Event, Thread
from typing import Any, TypeVar

from service.errors import Refusal
from service.errors.printable import printable_lines

T = TypeVar("T")
_POLL_SECONDS = 0.2  # between two checks whether the search is loaded
_SAY_SECONDS = 5.0  # between two lines that say how long something has taken so far
_KNOWN = frozenset(vars(logging.makeLogRecord({}))) | {"message", "asctime", "color_message"}

_VERBOSE = (  # loggers whose lines repeat what the service logs itself
    "uvicorn.access",
    "celery.worker.strategy",
    "celery.app.trace",
)


class PlainFormatter(logging.Formatter):
    """Formats a record as a plain line: the time, the message and the members added to it."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line."""
        added = {name: value for name, value in vars(record).items() if name not in _KNOWN}
        members = "".join(
            f" {name}={value:.3g}" if isinstance(value, float) else f" {name}={value}"
            for name, value in added.items()
        )
        return printable_lines(super().format(record) + members)


def logging_config(level: str = "INFO", plain: bool = False) -> dict[str, Any]:
    """Return a configuration of `logging` that writes a line for each record to standard error.

    The line is a JSON object, or if `plain` a line for people to read.
    """
    json_lines = {
        "()": "pythonjsonlogger.json.JsonFormatter",
        "format": "%(asctime)s %(levelname)s %(name)s %(message)s",
        "rename_fields": {"asctime": "time", "levelname": "level", "name": "logger"},
        "datefmt": "%Y-%m-%dT%H:%M:%S%z",
    }
    plain_lines = {
        "()": PlainFormatter,
        "format": "%(asctime)s %(message)s",
        "datefmt": "%H:%M:%S",
    }
    return {
        "version": 1,
        "disable_existing_loggers": False,
        "formatters": {"lines": plain_lines if plain else json_lines},
        "handlers": {"stderr": {"class": "logging.StreamHandler", "formatter": "lines"}},
        "root": {"level": level, "handlers": ["stderr"]},
        "loggers": {name: {"level": "WARNING"} for name in _VERBOSE},
    }


def log_loading(
    app: Any, check_ready: Callable[[], Awaitable[None]], compiling: Callable[[], object | None]
) -> None:
    """Make an application log, from its start on, how far its search is loaded.

    Args:
        check_ready: Raises a refusal until it is ready.
        compiling: Returns how far the compilation is, which may go on after that; else None.
    """
    lifespan: Callable[[Any], AbstractAsyncContextManager[Any]] = app.router.lifespan_context

    @asynccontextmanager
    async def lifespan_with_log(app: Any) -> AsyncIterator[Any]:
        async with lifespan(app) as state:
            logged = asyncio.create_task(_log_until_loaded(check_ready, compiling))
            yield state
            logged.cancel()

    app.router.lifespan_context = lifespan_with_log


async def _log_until_loaded(
    check_ready: Callable[[], Awaitable[None]], compiling: Callable[[], object | None]
) -> None:
    log = logging.getLogger("paretour")
    began = said = time.monotonic()
    log.info("loading the search")
    ready = False
    while not ready or compiling() is not None:
        with suppress(Refusal):
            await check_ready()
            if not ready:
                log.info("ready after %.1f s", time.monotonic() - began)
            ready = True
        if (progress := compiling()) is not None and time.monotonic() > said + _SAY_SECONDS:
            said = time.monotonic()
            log.info("%s", progress)
        await asyncio.sleep(_POLL_SECONDS)


@contextmanager
def logging_every(sentence: str, seconds: float = _SAY_SECONDS) -> Iterator[None]:
    """Log a sentence with the time so far, now and every few seconds until the block ends."""
    ended = Event()
    began = time.monotonic()

    def log() -> None:
        while True:
            logging.getLogger("paretour").info("%s, %.0f s", sentence, time.monotonic() - began)
            if ended.wait(seconds):
                return

    thread = Thread(target=log, name="log", daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def configure_logging(plain: bool = False) -> None:
    """Write logs from now on, as JSON unless plain; log warnings as `py.warnings`."""
    logging.config.dictConfig(logging_config(plain=plain))
    logging.captureWarnings(True)


def logged(load: Callable[[], T]) -> T:
    """Configure logging in a process that was just started, and return what `load` returns."""
    configure_logging(plain=sys.stderr.isatty())
    return load()


def trace(app: Any) -> None:
    """Send a span for each request to the collector at OTEL_EXPORTER_OTLP_ENDPOINT.

    The application is typed Any, because worker processes import this module without FastAPI.
    OpenTelemetry reads this variable, and all its others, by itself.

    Raises:
        ValueError: The extra for traces is not installed.
    """
    # Imported here, because OpenTelemetry is an extra.
    try:
        from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter
        from opentelemetry.instrumentation.fastapi import FastAPIInstrumentor
        from opentelemetry.sdk.resources import SERVICE_NAME, OTELResourceDetector, Resource
        from opentelemetry.sdk.trace import TracerProvider
        from opentelemetry.sdk.trace.export import BatchSpanProcessor
    except ImportError as error:
        sentence = "OTEL_EXPORTER_OTLP_ENDPOINT needs the extra paretour[tracing]"
        raise ValueError(f"{sentence}: {error}") from None

    resource = Resource({SERVICE_NAME: "paretour"}).merge(OTELResourceDetector().detect())
    provider = TracerProvider(resource=resource)
    provider.add_span_processor(BatchSpanProcessor(OTLPSpanExporter()))
    FastAPIInstrumentor.instrument_app(app, tracer_provider=provider)
