"""What the command writes to its log: an object a line."""

import json

import httpx

from tests.helpers.serving import running


def test_every_line_of_the_log_is_an_object_and_each_request_has_one() -> None:
    with running({}) as service:
        httpx.get(f"{service.url}/front/none?secret=1", headers={"X-Request-ID": "the-one"})
    lines = [json.loads(line) for line in service.log.splitlines()]
    assert {"time", "level", "logger", "message"} <= set.intersection(*map(set, lines))
    assert any("uvicorn" in line["logger"] for line in lines)
    [line] = [line for line in lines if line.get("request_id") == "the-one"]
    assert line["logger"] == "paretour.requests"
    assert (line["method"], line["path"], line["status"]) == ("GET", "/front/{id}", 404)
    assert line["caller"] == "anonymous"
    assert 0 < line["seconds"] < 10
    assert b"secret" not in service.log
