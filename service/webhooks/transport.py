"""Post to a webhook: only to checked addresses, without redirects or reading the answer's body.

The name of the host is resolved once. Its addresses are checked, and the connection goes to one of
them. So a second answer of the name service cannot lead the connection elsewhere (DNS rebinding).
The certificate must be for the name of the host.
"""

import asyncio
import logging
import socket
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor

import httpx

from service.webhooks.targets import Destination

_CONNECT_SECONDS = 5.0  # for each address
_MOST_ADDRESSES = 4  # of a host that are tried, one after another
_RESOLVED_AT_ONCE = 4  # names

# At INFO httpx logs every URL, and the URL of a webhook may hold a secret of its receiver.
for _name in ("httpx", "httpcore"):
    logging.getLogger(_name).setLevel(logging.WARNING)


class Undeliverable(Exception):
    """A webhook could not be posted. The message says why, without the URL."""


class WebhookTransport:
    """Posts to webhooks. It uses neither proxies nor passwords of the environment."""

    def __init__(self) -> None:
        # Threads of its own: a slow name service must not hold those of the event loop, which
        # requests need.
        self._resolving = ThreadPoolExecutor(_RESOLVED_AT_ONCE, thread_name_prefix="webhooks")
        self._certificates = httpx.create_ssl_context()

    async def post(self, destination: Destination, headers: Mapping[str, str], body: bytes) -> int:
        """Post a body, and return the status of the answer. The caller bounds the time.

        Raises:
            Undeliverable: The host is unknown, one of its addresses is not allowed, none can be
                connected to, or the connection fails.
        """
        addresses = await self._addresses(destination)
        failure = "there is no address"
        async with httpx.AsyncClient(
            verify=self._certificates,
            trust_env=False,
            timeout=httpx.Timeout(None, connect=_CONNECT_SECONDS),
        ) as client:
            for address in addresses[:_MOST_ADDRESSES]:
                request = _request(client, destination.url, address, headers, body)
                try:
                    response = await client.send(request, stream=True)
                except (httpx.ConnectError, httpx.ConnectTimeout) as error:
                    failure = _reason(error)
                except httpx.HTTPError as error:
                    raise Undeliverable(_reason(error)) from None
                else:
                    await response.aclose()  # its body is not read
                    return response.status_code
        raise Undeliverable(failure)

    def close(self) -> None:
        """End the threads that resolve names, without waiting for an answer."""
        self._resolving.shutdown(wait=False, cancel_futures=True)

    async def _addresses(self, destination: Destination) -> Sequence[str]:
        """Return all addresses of the host of a destination."""
        loop = asyncio.get_running_loop()
        host, port = destination.url.host, destination.port
        try:
            found = await loop.run_in_executor(self._resolving, _resolve, host, port)
        except (OSError, UnicodeError):
            raise Undeliverable("its host is unknown") from None
        if not all(destination.allows(address) for address in found):
            raise Undeliverable("its host has an address inside that its target does not name")
        return found


def _resolve(host: str, port: int) -> Sequence[str]:
    found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    return list(dict.fromkeys(str(address[0]) for *_, address in found))


def _request(
    client: httpx.AsyncClient,
    url: httpx.URL,
    address: str,
    headers: Mapping[str, str],
    body: bytes,
) -> httpx.Request:
    """Return the request to an address of the host. The certificate must name the host."""
    return client.build_request(
        "POST",
        url.copy_with(host=address),
        content=body,
        headers={
            "Host": url.netloc.decode(),
            "Accept-Encoding": "identity",
            "Content-Type": "application/json",
            "User-Agent": "paretour",
            **headers,
        },
        extensions={"sni_hostname": url.host},
    )


def _reason(error: httpx.HTTPError) -> str:
    """Return the kind of an error. Its text is left out, as it may have the URL."""
    return type(error).__name__
