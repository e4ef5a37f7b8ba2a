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
    ("hours", "least", "most"), [(1, 3000, 3600), (-1, 0.1, 0.1)], ids=["ahead", "gone"]
)
def test_a_pause_may_be_written_as_a_date(hours: int, least: float, most: float) -> None:
    written = format_datetime(datetime.now(UTC) + timedelta(hours=hours), usegmt=True)
    assert least <= retry_after(problem(503, "busy", **{"Retry-After": written})) <= most


def test_a_pause_that_is_neither_seconds_nor_a_date_is_a_second() -> None:
    assert retry_after(problem(503, "busy", **{"Retry-After": "soon"})) == 1
