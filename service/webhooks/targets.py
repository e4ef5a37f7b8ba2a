"""Check that a webhook goes to an origin that the operator allows, and to an allowed address.

A caller chooses the URL of a webhook. It could choose one that only the service can reach: that of
a database, the loopback, or the metadata of a cloud. Therefore the URL must have the scheme, host
and port of a target that the operator names. The addresses of its host must be public, or in the
network that the operator names with the target.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network, ip_address, ip_network
from typing import TYPE_CHECKING, Self

from service.errors import Refusal, invalid_header

if TYPE_CHECKING:
    import httpx  # imported late below: a process without webhooks needs no client of HTTP

MOST_LETTERS = 2000  # of a webhook's URL
_PORTS = {"http": 80, "https": 443}
_EXAMPLES = "https://hooks.example.com, or http://hooks.internal:8080=10.0.0.0/8"
# The metadata of Oracle's and Azure's clouds: `is_global` is true of their addresses.
_METADATA = (ip_network("192.0.0.0/24"), ip_network("168.63.129.16"))


@dataclass(frozen=True)
class Target:
    """An origin to which webhooks may go, and the network that its addresses must be in.

    Without a network the addresses must be public.
    """

    scheme: str
    host: str
    port: int
    network: IPv4Network | IPv6Network | None = None

    @classmethod
    def read(cls, text: str) -> Self:
        """Return the target of a text: ORIGIN or ORIGIN=NETWORK.

        If the host of the origin is an address, the network is that address by default. An origin
        with http needs a network.

        Raises:
            ValueError: The text has another form.
        """
        origin, _, named = text.partition("=")
        try:
            url = _parsed(origin)
            network = ip_network(named or url.host) if named or _is_address(url.host) else None
        except ValueError:
            raise ValueError(f"must be like {_EXAMPLES}") from None
        if url.raw_path != b"/" or (url.scheme == "http" and network is None):
            raise ValueError(f"must be like {_EXAMPLES}")
        return cls(url.scheme, url.host, _port_of(url), network)

    def has(self, url: "httpx.URL") -> bool:
        """Return whether a URL has this scheme, host and port."""
        return (url.scheme, url.host, _port_of(url)) == (self.scheme, self.host, self.port)

    def allows(self, address: str) -> bool:
        """Return whether a webhook of this origin may go to an address of its host."""
        ip = ip_address(address)
        if isinstance(ip, IPv6Address) and ip.ipv4_mapped is not None:
            ip = ip.ipv4_mapped
        return _is_public(ip) if self.network is None else ip in self.network


@dataclass(frozen=True)
class Destination:
    """The URL of a webhook, and all targets that have its origin.

    An origin may have several targets, each with another network.
    """

    url: "httpx.URL"
    targets: tuple[Target, ...]

    @property
    def port(self) -> int:
        """The port of the URL, or that of its scheme if the URL has none."""
        return _port_of(self.url)

    def allows(self, address: str) -> bool:
        """Return whether one of the targets lets the webhook go to an address of its host."""
        return any(target.allows(address) for target in self.targets)


class Targets:
    """All targets that the operator names; by default none."""

    def __init__(self, targets: Iterable[Target] = ()) -> None:
        self._targets = tuple(targets)

    def find(self, text: str) -> Destination | None:
        """Return the destination of a webhook's URL; None if it is not of a target.

        Raises:
            ValueError: The text is not an http or https URL that a webhook can have.
        """
        url = _parsed(text)
        of_its_origin = tuple(target for target in self._targets if target.has(url))
        return Destination(url, of_its_origin) if of_its_origin else None

    def check(self, text: str) -> None:
        """Check the URL that a caller names for a webhook.

        Raises:
            Refusal: The text is not a URL that a webhook can have, or it is not of a target.
        """
        try:
            found = self.find(text)
        except ValueError:
            values = {"limit": MOST_LETTERS, "came": len(text)}
            raise invalid_header("Webhook-Url", "not-an-address", **values) from None
        if found is None:
            raise Refusal("webhook-not-allowed", came=_origin_of(_parsed(text)))


def _parsed(text: str) -> "httpx.URL":
    """Return the http or https URL of a text."""
    if len(text) > MOST_LETTERS or not text.isascii() or not text.isprintable() or " " in text:
        raise ValueError
    import httpx

    try:
        url = httpx.URL(text)
    except httpx.InvalidURL:
        raise ValueError from None
    if url.scheme not in _PORTS or not url.host or url.port == 0 or url.userinfo or "#" in text:
        raise ValueError
    return url


def _port_of(url: "httpx.URL") -> int:
    return url.port or _PORTS[url.scheme]


def _origin_of(url: "httpx.URL") -> str:
    return f"{url.scheme}://{url.netloc.decode()}"


def _is_address(host: str) -> bool:
    try:
        ip_address(host)
    except ValueError:
        return False
    return True


def _is_public(ip: IPv4Address | IPv6Address) -> bool:
    """Return whether an address is on the internet, and does not stand for another address."""
    if isinstance(ip, IPv6Address) and ip.sixtofour is not None:
        return False
    inside = ip.is_multicast or ip.is_reserved or any(ip in network for network in _METADATA)
    return ip.is_global and not inside
