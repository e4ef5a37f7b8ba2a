"""The service starts in any environment, or ends soon with a sentence."""

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import httpx
import pytest

from tests.helpers.command import COMMAND, ROOT
from tests.helpers.ports import free_port
from tests.helpers.processes import serve_process

POSIX = {"LC_ALL": "POSIX", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
PAGES = ("/", "/guide", "/guide/limits", "/docs", "/openapi.json", "/page/main.js")


def test_every_page_is_there_where_the_locale_is_posix(quick_actors: dict[str, str]) -> None:
    odd = {"NUMBA_NUM_THREADS": "0", "OMP_NUM_THREADS": "many", "PARETOUR_WORKERS": "1"}
    with serve_process({**POSIX, **odd, **quick_actors}) as service:
        answers = {path: httpx.get(service.url + path, follow_redirects=True) for path in PAGES}
    assert {path: each.status_code for path, each in answers.items()} == dict.fromkeys(PAGES, 200)


@pytest.mark.parametrize(
    ("settings", "status", "sentence"),
    [
        ({"PARETOUR_ACTORS": "/no/such/folder"}, 2, "/no/such/folder must hold ONNX files"),
        ({"PARETOUR_HOST": "no-such-host.invalid"}, 3, "cannot listen at no-such-host.invalid"),
    ],
)
def test_what_keeps_a_service_from_starting_is_said_at_once(
    settings: Mapping[str, str], status: int, sentence: str
) -> None:
    command = [*COMMAND, "serve", "--workers", "1", "--port", str(free_port())]
    environment = {**os.environ, **settings}
    ended = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, timeout=300)
    assert ended.returncode == status
    assert sentence in ended.stderr.decode()


def test_a_service_without_a_folder_for_its_sockets_says_so() -> None:
    code = (
        "import tempfile; from service.__main__ import main;"
        "tempfile._candidate_tempdir_list = lambda: ['/proc']; main(['serve'])"
    )
    ended = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, timeout=300)
    assert ended.returncode == 2
    assert ended.stderr.startswith(b"paretour: TMPDIR must be a folder that can be written: ")


def test_names_are_printed_in_any_locale(tmp_path: Path, quick_actors: dict[str, str]) -> None:
    (tmp_path / "stops.csv").write_text(
        "id,x1,y1,x2,y2\nŁódź,1,2,3,4\nb,5,6,7,8\n", encoding="utf-8"
    )
    printed = {}
    for encoding in ("ascii", "latin-1"):
        command = [*COMMAND, "tour", str(tmp_path / "stops.csv"), "--time-limit", "0", "--knee"]
        odd = {"PYTHONIOENCODING": encoding, "NUMBA_DISABLE_JIT": "1"}
        environment = {**os.environ, **odd, **quick_actors}
        printed[encoding] = subprocess.run(
            command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, check=True
        ).stdout.decode(encoding.replace("ascii", "utf-8"))
    assert {encoding: sorted(text.split()) for encoding, text in printed.items()} == {
        "ascii": ["b", "Łódź"],
        "latin-1": ["\\u0141ód\\u017a", "b"],
    }
