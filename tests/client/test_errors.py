"""Refusals, and the pause before a retry."""

from datetime import UTC, datetime, timedelta
from email.utils import format_datetime

import httpx
import pytest
from paretour import Refused
from paretour.errors import retry_after

from tests.helpers.answers import Answers, Connect, problem


def test_what_is_no_problem_document_is_refused_all_the_same(connect: Connect) -> None:
    page = httpx.Response(502, text="<html>", headers={"Content-Type": "text/html"})
    with pytest.raises(Refused, match="502 Bad Gateway") as refused:
        connect(transport=Answers(page)).actors()
    assert refused.value.code == "unknown"


@pytest.mark.parametrize(
    ("written", "least", "most"),
    [
        (format_datetime(datetime.now(UTC) + timedelta(hours=1), usegmt=True), 3000, 3600),
        (format_datetime(datetime.now(UTC) - timedelta(hours=1), usegmt=True), 0.1, 0.1),
        ("soon", 1, 1),
    ],
)
def test_a_pause_may_be_written_as_a_date(written: str, least: float, most: float) -> None:
    assert least <= retry_after(problem(503, "busy", **{"Retry-After": written})) <= most
