"""Logs as lines of JSON, and traces for OpenTelemetry."""

from typing import Any

from fastapi import FastAPI

_TALKATIVE = ("uvicorn.access", "celery.worker.strategy", "celery.app.trace")


def logging_config(level: str = "INFO") -> dict[str, Any]:
    """For `logging.config.dictConfig`: everything goes to standard error, an object a line."""
    formatter = {
        "()": "pythonjsonlogger.json.JsonFormatter",
        "format": "%(asctime)s %(levelname)s %(name)s %(message)s",
        "rename_fields": {"asctime": "time", "levelname": "level", "name": "logger"},
        "datefmt": "%Y-%m-%dT%H:%M:%S%z",
    }
    return {
        "version": 1,
        "disable_existing_loggers": False,
        "formatters": {"json": formatter},
        "handlers": {"stderr": {"class": "logging.StreamHandler", "formatter": "json"}},
        "root": {"level": level, "handlers": ["stderr"]},
        # A line for each request is written by the service, which knows more of it.
        "loggers": {name: {"level": "WARNING"} for name in _TALKATIVE},
    }


def trace(app: FastAPI) -> None:
    """Send a span for each request to where OTEL_EXPORTER_OTLP_ENDPOINT points.

    The exporter reads that variable, and all others that OpenTelemetry has, by itself.

    Raises:
        ValueError: what this needs is not installed.
    """
    # Imported here, because whoever wants no traces need not install them.
    try:
        from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter
        from opentelemetry.instrumentation.fastapi import FastAPIInstrumentor
        from opentelemetry.sdk.resources import SERVICE_NAME, OTELResourceDetector, Resource
        from opentelemetry.sdk.trace import TracerProvider
        from opentelemetry.sdk.trace.export import BatchSpanProcessor
    except ImportError as error:
        sentence = "OTEL_EXPORTER_OTLP_ENDPOINT needs the extra paretour[tracing]"
        raise ValueError(f"{sentence}: {error}") from None

    named = Resource({SERVICE_NAME: "paretour"}).merge(OTELResourceDetector().detect())
    provider = TracerProvider(resource=named)
    provider.add_span_processor(BatchSpanProcessor(OTLPSpanExporter()))
    FastAPIInstrumentor.instrument_app(app, tracer_provider=provider)
