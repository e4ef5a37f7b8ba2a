"""Compress long answers with gzip, where a request accepts that."""

import asyncio
import re
import zlib

from starlette.requests import Request
from starlette.responses import Response

LEAST = 2**16  # bytes; shorter ones are sent as soon as they are compressed
_LEVEL = 1  # 6 MB of tours in a tenth of a second, to two fifths; 6 takes four times as long
_GZIP = 16  # added to the base-two logarithm of the window: zlib then writes gzip
_NONE = re.compile(r"q=0(\.0*)?", re.IGNORECASE)


async def compressed(request: Request, response: Response) -> Response:
    """Return a response, compressed if it is long and the request accepts gzip."""
    if len(response.body) < LEAST:
        return response
    response.headers.add_vary_header("Accept-Encoding")
    if accepts_gzip(request):
        response.body = await asyncio.to_thread(_gzip, bytes(response.body))
        response.headers["Content-Encoding"] = "gzip"
        response.headers["Content-Length"] = str(len(response.body))
    return response


def accepts_gzip(request: Request) -> bool:
    """Return whether a request names gzip, or all, in `Accept-Encoding`, with a weight above 0."""
    weights = {}
    for item in ",".join(request.headers.getlist("accept-encoding")).split(","):
        coding, *parameters = (part.strip() for part in item.split(";"))
        weights[coding.lower()] = not any(_NONE.fullmatch(each) for each in parameters)
    return weights.get("gzip", weights.get("*", False))


def _gzip(content: bytes) -> bytes:
    compressor = zlib.compressobj(_LEVEL, zlib.DEFLATED, _GZIP + zlib.MAX_WBITS)
    return compressor.compress(content) + compressor.flush()
