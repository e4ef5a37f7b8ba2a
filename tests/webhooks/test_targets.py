"""Webhooks go to the targets of the operator alone, and never to addresses inside by accident."""

import pytest

from service.errors import Refusal
from service.webhooks.targets import MOST_LETTERS, Target, Targets

HOOKS = Target.read("https://hooks.example.com")
PUBLIC = ("8.8.8.8", "1.1.1.1", "2606:4700::1111", "::ffff:8.8.8.8")
INSIDE = (
    *("127.0.0.1", "127.8.8.8", "0.0.0.0", "::1", "::", "::ffff:127.0.0.1", "::127.0.0.1"),
    *("10.0.0.1", "172.16.0.1", "192.168.1.1", "100.64.0.1", "fd00::1", "fc00::1"),
    *("169.254.169.254", "fe80::1", "fe80::1%eth0", "fd00:ec2::254", "100.100.100.200"),
    *("168.63.129.16", "192.0.0.192", "::ffff:169.254.169.254"),
    *("224.0.0.1", "239.255.255.250", "ff02::1", "255.255.255.255", "240.0.0.1"),
    *("64:ff9b::7f00:1", "64:ff9b::a9fe:a9fe", "2002:7f00:1::", "2001:0:7f00:1::"),
    *("192.0.2.1", "198.18.0.1", "2001:db8::1"),
)


@pytest.mark.parametrize("address", PUBLIC)
def test_a_public_address_is_allowed(address: str) -> None:
    assert HOOKS.allows(address)


@pytest.mark.parametrize("address", INSIDE)
def test_an_address_inside_is_not_allowed_unless_it_is_named(address: str) -> None:
    assert not HOOKS.allows(address)


@pytest.mark.parametrize(
    ("target", "allowed", "others"),
    [
        ("http://in.example:9000=10.1.0.0/16", ["10.1.2.3", "::ffff:10.1.2.3"], ["10.2.0.1"]),
        ("https://in.example=fd00::/8", ["fd12::1"], ["fe80::1", "10.1.2.3"]),
        ("http://10.0.0.5:9000", ["10.0.0.5"], ["10.0.0.6", "8.8.8.8"]),
        ("https://[::1]", ["::1"], ["127.0.0.1"]),
    ],
)
def test_a_network_that_is_named_is_the_only_one(
    target: str, allowed: list[str], others: list[str]
) -> None:
    read = Target.read(target)
    assert all(map(read.allows, allowed))
    assert not any(map(read.allows, others))


@pytest.mark.parametrize(
    "text",
    [
        *("", "hooks.example.com", "ftp://hooks.example.com", "https://", "https://h:0"),
        *("https://hooks.example.com/path", "https://hooks.example.com?x", "https://u:p@h.example"),
        *("http://hooks.example.com", "https://h.example=10.0.0.0/99", "https://h.example=inside"),
        *("https://h.example=10.0.0.1/8", "https://h.exämple", "*"),
    ],
)
def test_a_target_of_another_form_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"must be like https://hooks\.example\.com"):
        Target.read(text)


def test_an_origin_is_scheme_host_and_port() -> None:
    targets = Targets([HOOKS, Target.read("http://in.example:9000=10.0.0.0/8")])
    for url in (
        *("https://hooks.example.com", "https://HOOKS.example.com:443/a?b=c"),
        "http://in.example:9000/x",
    ):
        targets.check(url)
    for url in (
        *("http://hooks.example.com", "https://hooks.example.com:8443", "http://in.example"),
        *("https://hooks.example.com.", "https://evil.example", "https://a.hooks.example.com"),
        *("https://hooks.example.com.evil.example", "https://8.8.8.8"),
    ):
        with pytest.raises(Refusal) as refused:
            targets.check(url)
        assert refused.value.code == "webhook-not-allowed"
        assert refused.value.detail.endswith(url)


def test_a_host_may_have_several_networks() -> None:
    targets = Targets(
        [Target.read("http://in.example=10.0.0.0/8"), Target.read("http://in.example=fd00::/8")]
    )
    destination = targets.find("http://in.example/x")
    assert destination is not None
    assert destination.allows("10.0.0.1")
    assert destination.allows("fd00::1")
    assert not destination.allows("127.0.0.1")


@pytest.mark.parametrize(
    "url",
    [
        *("", "hooks.example.com", "//hooks.example.com", "file:///etc/passwd", "https:hooks"),
        *("https://hooks.example.com/a b", "https://hooks.example.com/\n", "https://h\x00"),
        *("https://user@hooks.example.com", "https://hooks.example.com/#f", "https://[::1"),
        "https://hooks.example.com\\@evil.example",
        *("https://hooks.example.com/é", "https://hooks.example.com/" + "x" * MOST_LETTERS),
    ],
)
def test_a_url_of_another_form_is_refused(url: str) -> None:
    with pytest.raises(Refusal) as refused:
        Targets([HOOKS]).check(url)
    assert refused.value.code in ("invalid-request", "webhook-not-allowed")
    if "evil" not in url:
        assert refused.value.code == "invalid-request"
