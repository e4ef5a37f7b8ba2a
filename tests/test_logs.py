"""What the command writes to its log: an object a line."""

import json
import os
import signal
import socket
import subprocess
import sys
import time

import httpx


def test_every_line_of_the_log_is_an_object_and_each_request_has_one() -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    url = f"http://127.0.0.1:{port}"
    command = [sys.executable, "-m", "service", "serve", "--port", str(port)]
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE) as server:
        try:
            until_live(url)
            httpx.get(f"{url}/front/none?secret=1", headers={"X-Request-ID": "the-one"})
        finally:
            server.send_signal(signal.SIGTERM)
            _, written = server.communicate(timeout=30)
    lines = [json.loads(line) for line in written.splitlines()]
    assert {"time", "level", "logger", "message"} <= set.intersection(*map(set, lines))
    assert any("uvicorn" in line["logger"] for line in lines)
    [line] = [line for line in lines if line.get("request_id") == "the-one"]
    assert line["logger"] == "paretour.requests"
    assert (line["method"], line["path"], line["status"]) == ("GET", "/front/{id}", 404)
    assert line["caller"] == "anonymous"
    assert 0 < line["seconds"] < 10
    assert b"secret" not in written


def until_live(url: str) -> None:
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        try:
            httpx.get(f"{url}/health/live").raise_for_status()
            return
        except httpx.ConnectError:
            time.sleep(0.05)
    raise TimeoutError("the server must start within 30 s")
