"""Traces of requests for OpenTelemetry, where an operator has said where they go."""

from fastapi import FastAPI


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
