"""Small files that would keep the reader busy for long are refused after little work."""

import time
from typing import Any

import pytest

import service.files.maps.reader  # noqa: F401  (loading it takes a while, which is not measured)
from service.errors import Refusal
from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile
from service.files.upload import Upload, read_upload
from service.files.work import UNITS, TooMuchWork, Work
from service.requests.multipart import split_files
from tests.files.hostile import HOSTILE
from tests.files.xlsx import TABLE, book
from tests.helpers.pace import seconds_of_loop
from tests.helpers.serving import LIMITS

# Times as long as a loop takes on this machine: 2.5 s where that is .1 s. They took from 2 to 90 s.
MOST_LOOPS = 25
FEW_SECONDS = 0.3  # are few on any machine
LARGE: dict[str, Any] = {"cities": 10_000, "cells": 2**20, "size": 1000, "body_bytes": 2**24}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_after_little_work(name: str) -> None:
    file = NamedFile(*HOSTILE[name]())
    limits = type(LIMITS)(**{**vars(LIMITS), **LARGE})
    begin = time.thread_time()
    with pytest.raises(Refusal) as refused:
        read_upload(Upload([file], None), limits, {})
    seconds = time.thread_time() - begin
    assert seconds < FEW_SECONDS or seconds < MOST_LOOPS * seconds_of_loop()
    assert refused.value.status in (413, 422)
    assert "MemoryError" not in refused.value.detail


def test_a_form_of_countless_boundaries_is_refused_at_the_first() -> None:
    begin = time.process_time()
    with pytest.raises(Refusal):
        split_files("multipart/form-data; boundary=b", b"--b\r\n\r\n\r\n\r\n" * 400_000 + b"--b--")
    assert time.process_time() - begin < 0.5


def test_the_files_of_a_request_share_one_budget() -> None:
    """Else eight files would hold the reader eight times as long."""
    rows = TABLE + "<row/>" * (UNITS // 2)
    name, data = "a.xlsx", book(rows)
    assert read_files([NamedFile(name, data)], Bounds()).kind == "front"
    with pytest.raises(ValueError, match="must have less beside its texts"):
        read_files([NamedFile(f"{at}.xlsx", data) for at in range(3)], Bounds())


def test_work_that_is_earned_can_be_spent() -> None:
    work = Work(10)
    work.earn(5)
    work.spend(15)
    with pytest.raises(TooMuchWork):
        work.spend(1)
    assert work.spent == 16


def test_a_long_table_earns_the_work_that_it_takes() -> None:
    """8,000 orders of twelve columns are read, though they have many tags."""
    heading = "".join(
        f"<c t='inlineStr'><is><t>{name}</t></is></c>" for name in ["id", "lat", "lon"]
    )
    filler = "<c><v>1</v></c>" * 9
    lines = [
        f"<row><c><v>{at}</v></c><c><v>{60 + at / 1e5}</v></c><c><v>24.5</v></c>{filler}</row>"
        for at in range(8_000)
    ]
    data = book(f"<row>{heading}</row>" + "".join(lines))
    [reading] = [read_files([NamedFile("long.xlsx", data)], Bounds())]
    assert len(reading.request["stops"]) == 8_000
