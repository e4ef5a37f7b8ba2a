"""Logs as lines of JSON, and traces for OpenTelemetry."""

from typing import Any

from fastapi import FastAPI

_VERBOSE = (  # loggers whose lines repeat what the service logs itself
    "uvicorn.access",
    "celery.worker.strategy",
    "celery.app.trace",
)


def logging_config(level: str = "INFO") -> dict[str, Any]:
    """Return a configuration of `logging`: JSON to standard error, one object a line."""
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
        "loggers": {name: {"level": "WARNING"} for name in _VERBOSE},
    }


def trace(app: FastAPI) -> None:
    """Send a span for each request to the collector at OTEL_EXPORTER_OTLP_ENDPOINT.

    OpenTelemetry reads that variable, and all its others, by itself.

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
