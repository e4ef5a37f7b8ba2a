"""Settings come from the environment, and wrong ones stop the server from starting."""

import base64
import re

import pytest
from pydantic import ValidationError

from service.__main__ import main
from service.cli.configuration import load_settings
from service.cli.errors import UsageError
from service.settings import Settings
from tests.helpers.documented import sentences_of
from tests.helpers.sampled import IS_WHOLE


def test_every_setting_has_a_default_and_says_what_it_is() -> None:
    Settings()
    assert all(sentences_of(Settings).get(name) for name in Settings.model_fields)


def test_a_setting_is_read_from_its_variable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PARETOUR_MAX_CITIES", "7")
    assert Settings().limits.cities == 7


@pytest.mark.parametrize(
    ("variable", "value"),
    [
        ("PARETOUR_PORT", "65536"),
        ("PARETOUR_PORT", "tcp://10.0.0.1:8000"),
        ("PARETOUR_WORKERS", "0"),
        ("PARETOUR_THREADS", "0"),
        ("PARETOUR_QUEUE", "-1"),
        ("PARETOUR_STORE_SECONDS", "0"),
        ("PARETOUR_MAX_CITIES", "many"),
        ("PARETOUR_ROOT_PATH", "tours"),
        ("PARETOUR_ROOT_PATH", "//other.example"),
        ("PARETOUR_ROUTER_URL", "valhalla:8002"),
        ("PARETOUR_ROUTER_URL", "http://"),
        ("PARETOUR_ROUTER_URL", "http://valhalla:none"),
        ("PARETOUR_ROUTER_URL", "http://valhalla:8002/?key=a"),
        ("PARETOUR_ROUTER", "graphhopper"),
        ("PARETOUR_ROUTER_PROFILE", "../../etc"),
        ("PARETOUR_ROUTER_PROFILES", "car"),
        ("PARETOUR_ROUTER_PROFILES", "car:../etc"),
        ("PARETOUR_ROUTER_SNAP", "nan"),
        ("PARETOUR_ROUTER_PAIRS", "1000000"),
    ],
)
def test_a_wrong_setting_is_refused(
    monkeypatch: pytest.MonkeyPatch, variable: str, value: str
) -> None:
    monkeypatch.setenv(variable, value)
    with pytest.raises(ValidationError):
        Settings()


def test_webhooks_need_targets_and_secrets(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Settings().webhooks is None
    monkeypatch.setenv("PARETOUR_WEBHOOK_TARGETS", "https://a.example, http://b.example=10.0.0.0/8")
    with pytest.raises(ValueError, match="TARGETS needs PARETOUR_WEBHOOK_SECRETS"):
        _ = Settings().webhooks
    one, two = (f"whsec_{base64.b64encode(bytes(32 + i)).decode()}" for i in range(2))
    monkeypatch.setenv("PARETOUR_WEBHOOK_SECRETS", f"{one},{two}")
    settings = Settings()
    assert settings.webhooks is not None
    settings.webhooks.check("http://b.example/x")
    assert [len(secret.key) for secret in settings.webhook_secrets] == [32, 33]
    assert one not in repr(settings)


@pytest.mark.parametrize("value", ["secret-of-ours", "whsec_c2VjcmV0"])
def test_a_wrong_secret_of_webhooks_is_not_shown(
    monkeypatch: pytest.MonkeyPatch, value: str
) -> None:
    sentence = refusal(monkeypatch, "PARETOUR_WEBHOOK_SECRETS", value)
    demand = "a secret must be whsec_ and 24 to 64 bytes in base64"
    assert sentence == f"PARETOUR_WEBHOOK_SECRETS, entry 1: {demand}"


@pytest.mark.parametrize(("router", "profile"), [("valhalla", "auto"), ("osrm", "driving")])
def test_the_routing_engine_is_that_of_the_settings(
    monkeypatch: pytest.MonkeyPatch, router: str, profile: str
) -> None:
    assert Settings().roads is None
    monkeypatch.setenv("PARETOUR_ROUTER_URL", "https://roads.example/engine")
    monkeypatch.setenv("PARETOUR_ROUTER", router)
    roads = Settings().roads
    assert roads is not None
    assert (roads.url, roads.router) == ("https://roads.example/engine", router)
    assert roads.profile == profile
    monkeypatch.setenv("PARETOUR_ROUTER_PROFILE", "truck")
    assert Settings().roads.profile == "truck"  # type: ignore[union-attr]
    known = ("car", "truck", "bicycle", "foot") if router == "valhalla" else ()
    assert Settings().limits.profiles == known
    monkeypatch.setenv("PARETOUR_ROUTER_PROFILES", "car:auto,van:auto_short")
    assert Settings().limits.profiles == ("car", "van")
    assert Settings().roads.profiles == {"car": "auto", "van": "auto_short"}  # type: ignore[union-attr]


def test_the_command_names_the_setting_that_is_wrong(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PARETOUR_QUEUE", "-1")
    with pytest.raises(SystemExit) as stopped:
        main(["serve"])
    assert stopped.value.code == 2
    assert (
        "PARETOUR_QUEUE: must be a whole number from 0 to 100000, got '-1'"
        in capsys.readouterr().err
    )


@pytest.mark.parametrize("command", ["serve", "work"])
@pytest.mark.parametrize(
    ("value", "shown"),
    [
        ("foo", "'foo'"),
        ("", "''"),
        ("http://redis:6379", "'http://redis:6379'"),
        ("redis://", "'redis://'"),
        ("redis://user:secret@host:port/0", "'redis://***@host:port/0'"),
    ],
)
def test_a_wrong_address_of_redis_is_a_sentence_that_names_the_variable(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    command: str,
    value: str,
    shown: str,
) -> None:
    monkeypatch.setenv("PARETOUR_REDIS_URL", value)
    with pytest.raises(SystemExit) as stopped:
        main([command])
    assert stopped.value.code == 2
    said = " ".join(capsys.readouterr().err.split())
    demand = "must be redis://HOST:PORT/NUMBER, or rediss:// for TLS"
    assert f"PARETOUR_REDIS_URL: {demand}, got {shown}" in said
    assert "secret" not in said


@pytest.mark.parametrize("url", ["redis://redis:6379/0", "rediss://:pw@[::1]:6380/1?x=y"])
def test_an_address_of_redis_is_taken(monkeypatch: pytest.MonkeyPatch, url: str) -> None:
    monkeypatch.setenv("PARETOUR_REDIS_URL", url)
    assert Settings().redis_url == url


def test_an_option_of_the_command_is_a_setting(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["serve", "--workers", "0"])
    assert "--workers: must be a whole number from 1 to 1024, got 0" in capsys.readouterr().err


def test_the_command_needs_an_actor(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: object
) -> None:
    monkeypatch.setenv("PARETOUR_ACTORS", str(tmp_path))
    with pytest.raises(SystemExit) as stopped:
        main(["serve"])
    assert stopped.value.code == 2
    assert f"{tmp_path} must hold ONNX files" in capsys.readouterr().err


def test_a_body_holds_matrices_of_as_many_cities_as_are_allowed() -> None:
    settings = Settings()
    assert settings.limits.most_cities("coordinates") == settings.max_cities
    assert 2 * 8 * settings.limits.most_cities("matrices") ** 2 + 2**10 <= settings.max_body_bytes


NUMBERS = {
    name: field.annotation
    for name, field in Settings.model_fields.items()
    if field.annotation in (int, float)
}
RANGE = re.compile(r"must be a (whole )?number from (\S+) to (\S+), got ")


def refusal(monkeypatch: pytest.MonkeyPatch, variable: str, value: str) -> str:
    """Set a variable, and return the sentence with which the command refuses to start."""
    monkeypatch.setenv(variable, value)
    with pytest.raises(UsageError) as raised:
        load_settings()
    return str(raised.value)


@pytest.mark.parametrize("name", NUMBERS)
def test_a_number_has_a_range_that_every_refusal_names(
    monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    variable, kind = f"PARETOUR_{name.upper()}", NUMBERS[name]
    sentence = refusal(monkeypatch, variable, "some")
    found = RANGE.search(sentence)
    assert found is not None
    assert bool(found[1]) == (kind is int)
    least, most = (float(bound) for bound in found.groups()[1:])
    assert 0 <= least < most <= 2**40
    outside = ["", "inf", "-inf", "nan", "1e400", "9" * 40, "-1", str(most + 1)]
    outside += ["1.5"] if kind is int else [str(least - 0.0005)]
    at = list(NUMBERS).index(name)
    for value in outside if IS_WHOLE else outside[at % 3 :: 3]:  # by day a third of them in turn
        sentence = refusal(monkeypatch, variable, value)
        assert sentence == f"{variable}: {found[0]}{value!r}"
    for bound in found.groups()[1:]:
        monkeypatch.setenv(variable, bound)
        assert getattr(load_settings(), name) == float(bound)


@pytest.mark.parametrize(
    "value",
    ["", "many", "inf/second", "0/second", "-1/minute", "1000001/second", "9/2 years"],
)
def test_a_rate_has_a_range_that_every_refusal_names(
    monkeypatch: pytest.MonkeyPatch, value: str
) -> None:
    sentence = refusal(monkeypatch, "PARETOUR_RATE", value)
    demand = "with 1 to 1000000 requests in a second, or longer, up to a year"
    assert sentence == f"PARETOUR_RATE: must be like 1000/minute, {demand}, got {value!r}"


@pytest.mark.parametrize("value", ["1/second", "1000000/year", "5 per 10 minutes"])
def test_a_rate_is_taken(monkeypatch: pytest.MonkeyPatch, value: str) -> None:
    monkeypatch.setenv("PARETOUR_RATE", value)
    assert load_settings().rate == value


def test_networks_build_tours_of_no_more_cities_than_they_can_number(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("PARETOUR_MAX_NETWORK_CITIES", "46000")
    assert load_settings().max_network_cities == 46_000
    assert "from 1 to 46000" in refusal(monkeypatch, "PARETOUR_MAX_NETWORK_CITIES", "46001")
