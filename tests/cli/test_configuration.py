"""Settings that cannot be used are the caller's to mend."""

from pathlib import Path

import pytest

from service.cli.configuration import load_settings, load_with
from service.cli.errors import UsageError
from service.settings import Settings


def test_options_stand_over_variables_where_they_are_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PARETOUR_PORT", "9000")
    monkeypatch.setenv("PARETOUR_QUEUE", "5")
    settings = load_settings(port=9001, queue=None)
    assert (settings.port, settings.queue) == (9001, 5)


def test_a_wrong_value_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PARETOUR_QUEUE", "some")
    with pytest.raises(UsageError, match=r"queue: .*got 'some'"):
        load_settings()


def test_files_that_are_missing_are_named(tmp_path: Path) -> None:
    def load(settings: Settings) -> bytes:
        return (settings.actors / "none.onnx").read_bytes()

    with pytest.raises(UsageError, match=r"none\.onnx"):
        load_with(load, load_settings(actors=tmp_path))
