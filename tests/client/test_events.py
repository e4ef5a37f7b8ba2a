"""The progress of a job, over connections that may break."""

import httpx
import pytest
from paretour import Refused

from tests.helpers.answers import Answers, Connect, events, problem, progress, status


def test_progress_outlives_connections_that_break(connect: Connect) -> None:
    service = Answers(
        events(status("running"), progress(0.3)),
        httpx.ReadError("reset"),
        problem(503, "queue-full", **{"Retry-After": "0"}),
        events(progress(0.4), status("done")),
    )
    job = connect(transport=service).job("f")
    assert [item.hypervolume for item in job.progress()] == [0.3, 0.4]


@pytest.mark.parametrize(
    ("name", "sent"),
    [("running.0a.", "running.0a."), ("é", None), ("\x01", None), ("x" * 999, None)],
)
def test_a_stream_that_broke_goes_on_after_its_last_event(
    connect: Connect, name: str, sent: str | None
) -> None:
    text = f'id: {name}\nevent: status\ndata: {{"status": "running"}}\n\n'
    broken = httpx.Response(200, text=text, headers={"Content-Type": "text/event-stream"})
    service = Answers(broken, events(status("done")))
    assert list(connect(transport=service).job("f").progress()) == []
    first, second = (request.headers for request in service.requests)
    assert "last-event-id" not in first
    assert second.get("last-event-id") == sent


def test_progress_of_what_is_gone_for_good_is_refused(connect: Connect) -> None:
    with pytest.raises(Refused):
        list(connect(transport=Answers(problem(404, "unknown-front"))).job("f").progress())


def test_progress_is_not_waited_for_without_end(connect: Connect) -> None:
    service = Answers(*[httpx.ReadError("reset")] * 9)
    with pytest.raises(httpx.ReadError):
        list(connect(transport=service, patience=1).job("f").progress())
    assert len(service.requests) == 2


def test_a_page_in_place_of_the_events_is_a_broken_connection(connect: Connect) -> None:
    page = httpx.Response(200, text="<html>", headers={"Content-Type": "text/html"})
    service = Answers(page, events(status("done")))
    assert list(connect(transport=service).job("f").progress()) == []
    assert len(service.requests) == 2
    assert service.requests[0].headers["accept"] == "text/event-stream"


def test_a_stream_that_always_begins_alike_and_ends_is_not_followed_for_ever(
    connect: Connect,
) -> None:
    service = Answers(*[events(status("later"))] * 9)
    with pytest.raises(httpx.RemoteProtocolError, match="ended before the job did"):
        list(connect(transport=service, patience=1.5).job("f").progress())
    assert len(service.requests) < 9
