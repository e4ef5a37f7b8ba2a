"""The network that an address counts for, and which addresses are proxies."""

from collections.abc import Callable
from functools import lru_cache
from ipaddress import IPv6Address, ip_address, ip_network

from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware


@lru_cache(maxsize=1024)  # each request calls it several times
def network_of(address: str) -> str:
    """Return an IPv4 address as it is, and for IPv6 the /64 network, which one client has.

    >>> network_of("192.0.2.7"), network_of("2001:db8:1:2:3:4:5:6")
    ('192.0.2.7', '2001:db8:1:2::/64')
    """
    try:
        parsed = ip_address(address)
    except ValueError:  # text of a proxy, which need not be an address
        return address[:64]
    if not isinstance(parsed, IPv6Address):
        return address
    if parsed.ipv4_mapped is not None:
        return str(parsed.ipv4_mapped)
    return str(ip_network((parsed.packed, 64), strict=False))


def proxies_of(hosts: str) -> Callable[[str], bool]:
    """Return a function that tells whether uvicorn would trust an address as a proxy.

    Args:
        hosts: Addresses and networks, separated by commas, or *, as in FORWARDED_ALLOW_IPS.

    >>> proxies_of("10.0.0.0/8, 192.0.2.1")("10.1.2.3")
    True
    """
    return ProxyHeadersMiddleware(_no_app, hosts).trusted_hosts.__contains__


async def _no_app(*_: object) -> None:
    """Stand in for an application, which is never called."""
