"""The commands of an operator that can be tested without a service of their own."""

import hashlib
import os
import pty
import re
import signal
import time
from pathlib import Path

import psutil
import pytest
import typer

from service.cli.commands import key, serve, work
from tests.helpers.command import started

INTERRUPTED = 130


def test_a_key_is_printed_with_its_entry(capsys: pytest.CaptureFixture[str]) -> None:
    key("dispatch")
    made, entry = capsys.readouterr().out.splitlines()
    assert entry == f"dispatch:{hashlib.sha256(made.encode()).hexdigest()}"


def test_a_caller_with_a_name_that_no_entry_can_hold_gets_no_key(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(typer.Exit) as ended:
        key("the lab")
    assert ended.value.exit_code == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "a caller must be named by 1 to 64 letters" in printed.err


def test_a_wrong_setting_ends_with_2(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(typer.Exit) as ended:
        serve(host=None, port=70000, workers=None)
    assert ended.value.exit_code == 2
    assert "port: " in capsys.readouterr().err


def test_on_a_terminal_a_service_says_in_plain_lines_where_it_is_and_when_it_is_ready() -> None:
    terminal, other_end = pty.openpty()
    with started("serve", "--port", 0, "--workers", 1, stderr=other_end) as running:
        os.close(other_end)
        shown = b""
        while b"ready after" not in shown:
            shown += os.read(terminal, 1024)
        running.terminate()
    os.close(terminal)
    assert running.returncode == 0
    assert re.search(rb"running on http://127\.0\.0\.1:\d{2,5}", shown)
    assert b"loading the search" in shown
    assert b'{"' not in shown


def test_ctrl_c_while_a_service_starts_ends_it_without_a_word(tmp_path: Path) -> None:
    with (
        (tmp_path / "stderr").open("w+") as stderr,
        started("serve", "--port", 0, stderr=stderr.fileno()) as running,
    ):
        process = psutil.Process(running.pid)
        while len(children := process.children()) < 2:  # one of multiprocessing's, and the forking
            assert running.poll() is None
            time.sleep(0.01)
        for each in (*children, process):  # as a terminal does
            each.send_signal(signal.SIGINT)
        running.wait()
        psutil.wait_procs(children)
        stderr.seek(0)
        assert stderr.read() == ""
    assert running.returncode == INTERRUPTED


def test_without_redis_there_is_no_worker_to_ask_after(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("PARETOUR_REDIS_URL", raising=False)
    with pytest.raises(typer.Exit) as ended:
        work(alive=True)
    assert ended.value.exit_code == 2
    assert "PARETOUR_REDIS_URL must say" in capsys.readouterr().err
