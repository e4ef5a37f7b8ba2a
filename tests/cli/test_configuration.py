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
    with pytest.raises(UsageError, match=r"^PARETOUR_QUEUE: .*got 'some'"):
        load_settings()


def test_files_that_are_missing_are_named(tmp_path: Path) -> None:
    def load(settings: Settings) -> bytes:
        return (settings.actors / "none.onnx").read_bytes()

    with pytest.raises(UsageError, match=r"none\.onnx"):
        load_with(load, load_settings(actors=tmp_path))


def test_an_entry_of_a_list_is_named_by_its_number(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PARETOUR_API_KEYS", f"us:{'0' * 64},them")
    with pytest.raises(UsageError, match=r"^PARETOUR_API_KEYS, entry 2: "):
        load_settings()


@pytest.mark.parametrize(
    ("variable", "sentence"),
    [
        ("PARETOUR_WORKER", "PARETOUR_WORKER is not a setting; did you mean PARETOUR_WORKERS?"),
        ("PARETOUR_APIKEYS", "PARETOUR_APIKEYS is not a setting; did you mean PARETOUR_API_KEYS?"),
        ("Paretour_Quue", "Paretour_Quue is not a setting; did you mean PARETOUR_QUEUE?"),
        ("PARETOUR_", "PARETOUR_ is not a setting"),
        ("PARETOUR_XYZZY", "PARETOUR_XYZZY is not a setting"),
    ],
)
def test_a_misspelled_variable_is_named_with_the_nearest_setting(
    monkeypatch: pytest.MonkeyPatch, variable: str, sentence: str
) -> None:
    monkeypatch.setenv(variable, "1")
    with pytest.raises(UsageError) as raised:
        load_settings()
    assert str(raised.value).startswith(sentence)


def test_variables_of_the_command_and_of_orchestrators_pass(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name, value in (
        ("PARETOUR_API_KEY", "secret"),
        ("paretour_queue", "3"),
        ("PARETOUR_SERVICE_HOST", "10.0.0.1"),
        ("PARETOUR_SERVICE_PORT_HTTP", "80"),
        ("PARETOUR_REDIS_PORT", "tcp://10.0.0.2:6379"),
        ("PARETOUR_REDIS_PORT_6379_TCP_ADDR", "10.0.0.2"),
    ):
        monkeypatch.setenv(name, value)
    assert load_settings().queue == 3


@pytest.mark.parametrize(
    ("variable", "value"),
    [
        ("PARETOUR_API_KEYS", "sesame"),
        ("PARETOUR_API_KEYS", "open sesame:12"),
        ("PARETOUR_API_KEYS", "us:sesame"),
        ("PARETOUR_REDIS_URL", "redis://:sesame@"),
        ("PARETOUR_REDIS_URL", "http://redis?password=sesame"),
        ("PARETOUR_ROUTER_URL", "ftp://us:sesame@router"),
        ("PARETOUR_ROUTER_URL", "http://router/?key=sesame"),
        ("PARETOUR_TILES", "https://tiles.example/{z}/{x}.png?api_key=sesame"),
        ("PARETOUR_TILES", "https://tiles.example/{z}/{x}.png?v=1&api_key=sesame"),
        ("PARETOUR_PORT", "redis://:sesame@redis:6379"),
    ],
)
def test_a_wrong_setting_that_may_hold_a_secret_is_named_without_it(
    monkeypatch: pytest.MonkeyPatch, variable: str, value: str
) -> None:
    monkeypatch.setenv(variable, value)
    with pytest.raises(UsageError, match=rf"^{variable}") as raised:
        load_settings()
    assert "sesame" not in str(raised.value)
