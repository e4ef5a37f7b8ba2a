"""Names that travel over Redis: replicas and workers of other releases read them."""

from service.cluster.celery_app import QUEUE, TASK
from service.cluster.records import STOP_REASONS, TAKEN_OVER, record_arguments, report_arguments
from service.cluster.script import CHANNEL, SCRIPT
from service.errors import Cancelled, DeadlineExceeded
from service.jobs.record import UNFINISHED
from service.watch import Progress
from tests.helpers.scripted_runner import document
from tests.helpers.stores import job, record


def test_stop_reasons_keep_their_names() -> None:
    assert {Cancelled: b"Stopped", DeadlineExceeded: b"Overdue"} == STOP_REASONS
    assert TAKEN_OVER == b"taken"


def test_statuses_queue_and_channel_keep_their_names() -> None:
    assert UNFINISHED == ("queued", "running")
    assert (QUEUE, TASK, CHANNEL) == ("paretour", "paretour.plan", "paretour:told")


def test_fields_of_a_record_keep_their_names() -> None:
    count, *arguments = record_arguments(job("a", key="k", digest="d"))
    assert arguments[:count:2] == [
        *("id", "caller", "request_id", "status", "key", "digest", "problem"),
        *("members", "tours", "ends", "angles"),
    ]
    assert arguments[count::2] == ["kind", "body"]
    count, *arguments = record_arguments(record("a", front=document("converged", gained=0.5)))
    assert arguments[count - 2 :] == ["gained", 0.5]


def test_fields_of_a_report_keep_their_names() -> None:
    arguments = report_arguments(17, Progress(0.5, 0.25, 3), document(None))
    assert arguments[::2] == ["members", "tours", "ends", "angles", "progress", "process"]
    assert arguments[-3] == b'{"seconds":0.5,"hypervolume":0.25,"points":3}'


def test_the_script_sets_the_fields_that_are_read() -> None:
    for name in (
        "kept",
        "attempts",
        "stop",
        "seen",
        "sent",
        "worker",
        "claimed",
        "number",
        "message",
    ):
        assert f"'{name}'" in SCRIPT
