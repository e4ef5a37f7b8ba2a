"""Ask a routing engine over HTTP: few questions at once, bounded answers, few retries.

The engine is not trusted: no redirect is followed, nothing is decompressed, and no answer is read
beyond its limit of bytes. Addresses and bodies, which name places, are neither
logged nor quoted.
"""

import asyncio
import logging
import ssl
import time
from collections.abc import Callable
from typing import Literal

import httpx

from service.errors import RouterUnavailable, RouterUnusable
from service.roads.router import Answer, RouterRequest

Outcome = Literal["answered", "unavailable", "unusable"]
Observe = Callable[[Outcome, float], None]

AT_ONCE = 4  # questions to the engine
_PAUSES = (0.1, 0.4)  # seconds before the second attempt and the third
_BUSY = frozenset({429, 502, 503, 504})  # statuses after which to ask again
_UNDERSTOOD = frozenset({200, 400})  # statuses with an answer in the engine's own form
_CONNECT_SECONDS = 2.0
_IDLE_SECONDS = 4.0  # OSRM closes connections that were silent for five

# At INFO httpx logs every address, and OSRM's addresses are places.
for _name in ("httpx", "httpcore"):
    logging.getLogger(_name).setLevel(logging.WARNING)


class RouterTransport:
    """A client of the engine at a URL, for one event loop.

    Args:
        url: The engine's address, to which paths are added.
        observe: Called with the outcome and the seconds of every attempt.
    """

    def __init__(self, url: str, observe: Observe = lambda *_: None) -> None:
        self._url = url.rstrip("/")
        self._observe = observe
        self._turn = asyncio.Semaphore(AT_ONCE)
        self._client = httpx.AsyncClient(
            verify=_certificates(url),
            trust_env=False,  # neither proxies nor the passwords in .netrc
            headers={"Accept-Encoding": "identity", "User-Agent": "paretour"},
            timeout=httpx.Timeout(None, connect=_CONNECT_SECONDS),
            limits=httpx.Limits(max_connections=AT_ONCE, keepalive_expiry=_IDLE_SECONDS),
        )

    async def ask(self, question: RouterRequest) -> Answer:
        """Return the engine's answer. The caller bounds the time.

        Raises:
            RouterUnavailable: Three attempts had no answer, or the answer that the engine is busy.
            RouterUnusable: The answer is too long, or not from a routing engine.
        """
        for pause in _PAUSES:
            try:
                return await self._attempt(question)
            except RouterUnavailable:
                await asyncio.sleep(pause)
        return await self._attempt(question)

    async def close(self) -> None:
        """Close the connections."""
        await self._client.aclose()

    async def _attempt(self, question: RouterRequest) -> Answer:
        outcome: Outcome = "unavailable"
        async with self._turn:
            began = time.perf_counter()
            try:
                answer = await self._exchange(question)
                outcome = "answered"
            except RouterUnusable:
                outcome = "unusable"
                raise
            except (httpx.HTTPError, httpx.InvalidURL):
                # Not chained: its text may have the address, and so the places.
                raise RouterUnavailable from None
            finally:
                self._observe(outcome, time.perf_counter() - began)
        return answer

    async def _exchange(self, question: RouterRequest) -> Answer:
        method = "GET" if question.body is None else "POST"
        headers = {} if question.body is None else {"Content-Type": "application/json"}
        async with self._client.stream(
            method, self._url + question.path, content=question.body, headers=headers
        ) as response:
            if response.status_code in _BUSY:
                raise RouterUnavailable
            if response.status_code not in _UNDERSTOOD:
                raise RouterUnusable(f"its status is {response.status_code}")
            if response.headers.get("Content-Encoding", "identity") != "identity":
                raise RouterUnusable("it is compressed, though not asked to be")
            return Answer(response.status_code, await _content(response, question.most_bytes))


async def _content(response: httpx.Response, most: int) -> bytes:
    """Return the body of a response."""
    content = bytearray()
    async for chunk in response.aiter_raw():
        content += chunk
        if len(content) > most:
            raise RouterUnusable(f"it has more than {most} bytes")
    return bytes(content)


def _certificates(url: str) -> ssl.SSLContext:
    """Return the certificates to trust: for plain HTTP none, as they take 40 ms to load."""
    if url.lower().startswith("https:"):
        return ssl.create_default_context()
    return ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
