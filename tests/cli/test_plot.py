"""A front drawn into a file."""

import os
from pathlib import Path

import pytest
from paretour.values import parse_front

from service.cli.errors import UsageError
from service.cli.plot import check_path, plot_front
from tests.helpers.answers import FRONT, NAMED


def test_a_front_is_a_picture(tmp_path: Path) -> None:
    path = tmp_path / "front.png"
    check_path(path)
    plot_front(parse_front(FRONT), path)
    assert path.read_bytes().startswith(b"\x89PNG")


def test_axes_have_names_and_units_as_they_are(tmp_path: Path) -> None:
    plot_front(parse_front(NAMED), tmp_path / "front.svg")
    plot_front(parse_front(FRONT), tmp_path / "short.svg")
    named, short = ((tmp_path / name).read_text() for name in ("front.svg", "short.svg"))
    assert "<!-- way (m) -->" in named
    assert "<!-- risk [red]$ -->" in named
    assert "<!-- first length -->" in short


@pytest.mark.parametrize("name", ["front.txt", "front", "none/front.png"])
def test_a_path_that_cannot_be_drawn_into_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(UsageError, match=f"got {tmp_path / name}"):
        check_path(tmp_path / name)


def test_a_pipe_is_not_drawn_into(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "front.png")
    with pytest.raises(UsageError, match=r"--plot must be a file, got .*front\.png"):
        check_path(tmp_path / "front.png")
