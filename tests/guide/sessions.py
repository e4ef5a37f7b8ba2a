"""Run the blocks of a page, from top to bottom, as its reader would."""

import itertools
import json
import os
import re
import shlex
import subprocess
import sys
from contextlib import chdir
from pathlib import Path
from typing import Any

import numpy as np
import playwright
import pytest

from tests.guide.pages import README, ROOT, Block, blocks, split_commands
from tests.helpers.command import paretour

REACHED = "localhost:8000"
RUN = ("curl ", "paretour ", "cat ", "sh ", "node ")
# Node.js comes with playwright.
NODE = Path(playwright.__file__).parent / "driver/node"


def write_inputs(folder: Path) -> None:
    """Write the files that commands of the pages read, and the commands `paretour` and `node`."""
    [request] = [block.text for block in blocks(README) if block.title == "cities.json"]
    (folder / "cities.json").write_text(request)
    rng = np.random.default_rng(0)
    np.save(folder / "costs.npy", rng.random((2, 7, 7)))
    (folder / "service").symlink_to(ROOT / "service")
    command = folder / "bin" / "paretour"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec {sys.executable} -m service "$@"\n')
    command.chmod(0o755)
    command.with_name("node").symlink_to(NODE)


def run_page(page: Path, folder: Path, address: str) -> list[str]:
    """Run all of a page's blocks that can be run here, and return what each command printed."""
    printed: list[str] = []
    reached = address.removeprefix("http://")
    answered = _answered(page)
    for block in blocks(page):
        if block.title == "answer":
            found, expected = json.loads(printed[-1]), json.loads(block.text)
            assert lasting(found) == lasting(expected), (found, expected)
        elif block.title:
            text = _unhurried(block.text) if block.title in answered else block.text
            (folder / block.title).write_text(text.replace(REACHED, reached))
        else:
            printed += _run(block, folder, reached)
    return printed


def _answered(page: Path) -> set[str]:
    """Return the names of the requests whose answers a page prints."""
    return {
        name
        for asked, answer in itertools.pairwise(blocks(page))
        if answer.title == "answer"
        for name in re.findall(r"-d @(\S+)", asked.text)
    }


def _unhurried(request: str) -> str:
    """Return a request with more time than its search takes on any machine before it converges."""
    return json.dumps({**json.loads(request), "time_limit": 60})


def lasting(answer: dict[str, Any]) -> dict[str, Any]:
    """Return the answer without what differs from run to run; each tour in one direction."""
    front = [
        {
            "angle": round(item["angle"], 6),
            "lengths": [round(length, 6) for length in item["lengths"]],
            "tour": min(item["tour"], item["tour"][:1] + item["tour"][:0:-1]),
        }
        for item in answer["front"]
    ]
    changed = {"front": front, "hypervolume": round(answer["hypervolume"], 6)}
    kept = {name: value for name, value in answer.items() if name not in ("id", "timings_ms")}
    return kept | changed


def _run(block: Block, folder: Path, reached: str) -> list[str]:
    if block.language == "python":
        with chdir(folder):
            exec(block.text.replace(REACHED, reached), {})
    if block.language != "sh":
        return []
    commands = [line for line in split_commands(block.text) if line.startswith(RUN)]
    return [printed_by(line.replace(REACHED, reached), folder) for line in commands]


def printed_by(command: str, folder: Path) -> str:
    """Run a command of a page in a folder, and return what it printed; fail if it fails."""
    if command.startswith("paretour "):
        return _printed_by_paretour(command, folder)
    path = f"{folder / 'bin'}:{os.environ['PATH']}"
    imported = f"{ROOT}:{ROOT / 'service/client'}"
    command = command.replace("curl ", "curl --silent --show-error --fail-with-body ", 1)
    ended = subprocess.run(
        command,
        shell=True,
        cwd=folder,
        env={**os.environ, "PATH": path, "PYTHONPATH": imported},
        capture_output=True,
        text=True,
    )
    if ended.returncode:
        pytest.fail(f"{command}\n{ended.stdout}{ended.stderr}")
    return ended.stdout


def _printed_by_paretour(command: str, folder: Path) -> str:
    """Run the command without a shell, which would start Python anew, and return its output."""
    text, _, file = command.partition(" > ")
    words = shlex.split(text)[1:]
    if "service/examples/" in text or "--robot" in text:  # which are planned for a second or more
        words += ["--time-limit", "0.1"]
    ended = paretour(*words, folder=folder)
    if ended.returncode:
        pytest.fail(f"{command}\n{ended.stdout}{ended.stderr}")
    if file:
        (folder / file).write_text(ended.stdout)
        return ""
    return ended.stdout
