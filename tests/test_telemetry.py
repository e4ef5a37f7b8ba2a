"""The log of the command, one object a line, and traces as a collector receives them."""

import json
import logging
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler

import httpx
import pytest
from fastapi import FastAPI
from opentelemetry.proto.collector.trace.v1.trace_service_pb2 import ExportTraceServiceRequest

from service.telemetry import PlainFormatter, logging_every, trace
from tests.helpers.command import paretour
from tests.helpers.http_handler import serving_handler
from tests.helpers.processes import serve_process


def test_a_warning_of_python_is_a_line_of_the_log_in_worker_processes_too() -> None:
    load = "lambda: warnings.warn('overflow\\nof a request', RuntimeWarning)"
    code = f"import warnings; from service.telemetry import logged; logged({load})"
    process = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    [line] = [json.loads(line) for line in process.stderr.splitlines()]
    assert (line["logger"], line["level"]) == ("py.warnings", "WARNING")
    assert "overflow\nof a request" in line["message"]


def test_the_runner_of_every_worker_is_loaded_with_the_log_as_objects() -> None:
    code = (
        "import logging; from service.settings import Settings; from service import server;"
        "server._make_runner(Settings())(); logging.getLogger('x').warning('a line')"
    )
    process = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert json.loads(process.stderr)["message"] == "a line"


@contextmanager
def collector() -> Iterator[tuple[str, list[ExportTraceServiceRequest]]]:
    """The address of a collector, and what it has been sent."""
    received: list[ExportTraceServiceRequest] = []

    class Collect(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            received.append(ExportTraceServiceRequest.FromString(body))
            self.send_response(200)
            self.end_headers()

        def log_message(self, *_: object) -> None:
            """Not to standard error."""

    with serving_handler(Collect) as url:
        yield url, received


@dataclass(frozen=True)
class Served:
    """What was asked of a service with keys and traces, and what it told of that."""

    log: bytes
    spans: list[ExportTraceServiceRequest]
    key: str
    lets_in: list[int]


@pytest.fixture(scope="module")
def served(quick_actors: dict[str, str]) -> Served:
    """A service that has ended, which let in the caller of a key that the command made."""
    key, entry = paretour("key", "dispatch").stdout.splitlines()
    bearer = {"Authorization": f"Bearer {key}"}
    with collector() as (endpoint, received):
        settings = {"PARETOUR_API_KEYS": f" {entry} , lab:{64 * '0'}", "PARETOUR_WORKERS": "1"}
        traced = {"OTEL_EXPORTER_OTLP_ENDPOINT": endpoint}
        with serve_process({**settings, **traced, **quick_actors}) as service:
            request = {"X-Request-ID": "the-one", **bearer}
            httpx.get(f"{service.url}/front/none?secret=1", headers=request)
            asked = [httpx.get(f"{service.url}/actors", headers=each) for each in (bearer, {})]
    return Served(service.log, received, key, [answer.status_code for answer in asked])


def test_the_command_makes_a_key_that_its_entry_lets_in(served: Served) -> None:
    assert served.lets_in == [200, 401]
    assert served.key.encode() not in served.log


def test_every_line_of_the_log_is_an_object_and_each_request_has_one(served: Served) -> None:
    lines = [json.loads(line) for line in served.log.splitlines()]
    assert {"time", "level", "logger", "message"} <= set.intersection(*map(set, lines))
    assert any("uvicorn" in line["logger"] for line in lines)
    [line] = [line for line in lines if line.get("request_id") == "the-one"]
    assert line["logger"] == "paretour.requests"
    assert (line["method"], line["path"], line["status"]) == ("GET", "/front/{id}", 404)
    assert line["caller"] == "dispatch"
    assert line["seconds"] > 0
    assert b"secret" not in served.log


def test_each_request_is_a_span_at_the_collector(served: Served) -> None:
    resources = [each for request in served.spans for each in request.resource_spans]
    named = {
        (each.key, each.value.string_value)
        for resource in resources
        for each in resource.resource.attributes
    }
    assert ("service.name", "paretour") in named
    spans = [span for each in resources for scope in each.scope_spans for span in scope.spans]
    assert "GET /front/{id}" in {span.name for span in spans}


def test_traces_without_their_extra_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    # What Python itself takes for a package that is not there.
    monkeypatch.setitem(sys.modules, "opentelemetry.sdk", None)
    with pytest.raises(ValueError, match=r"needs the extra paretour\[tracing\]: .*opentelemetry"):
        trace(FastAPI())


def test_a_plain_line_has_the_members_of_a_record_behind_its_message() -> None:
    record = logging.makeLogRecord({"msg": "request", "status": 200, "seconds": 0.01234})
    record.color_message = "coloured"
    line = PlainFormatter("%(message)s").format(record)
    assert line == "request status=200 seconds=0.0123"


def test_while_something_takes_long_the_log_says_so_again(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, "paretour"), logging_every("it goes on", seconds=0.01):
        while sum("it goes on" in line for line in caplog.messages) < 3:
            time.sleep(0.005)
    said = len(caplog.messages)
    time.sleep(0.05)
    assert len(caplog.messages) == said
