"""Read the bodies of responses as they arrive, within bounds of size and of time."""

import time
import zlib
from collections.abc import Iterator

import httpx
from paretour.expect import Members, UnexpectedAnswer, parse_json, unexpected

MOST_BYTES = 2**27  # of an answer, decompressed: what the service has for all its answers together
ACCEPTED = {"Accept-Encoding": "gzip"}
_PIECE = 2**16  # bytes that are decompressed at a time
_LEAST_PACE = 1000  # bytes per second after the timeout; slower answers are aborted
_GZIP = 16 + zlib.MAX_WBITS


class Decoder:
    """Decompresses the chunks of a response, in pieces of bounded length."""

    def __init__(self, response: httpx.Response) -> None:
        self._gzip = None
        # A response that was already read comes from a test, and httpx has decoded its content.
        encoding = "" if response.is_stream_consumed else response.headers.get("Content-Encoding")
        if (encoding or "identity").lower() == "gzip":
            self._gzip = zlib.decompressobj(_GZIP)
        elif encoding and encoding.lower() != "identity":
            raise unexpected("Content-Encoding", "gzip or identity", encoding)

    def decoded(self, chunk: bytes) -> Iterator[bytes]:
        """Yield the decompressed content of a chunk."""
        if self._gzip is None:
            yield chunk
            return
        while chunk and not self._gzip.eof:
            try:
                yield self._gzip.decompress(chunk, _PIECE)
            except zlib.error as error:
                raise UnexpectedAnswer(f"answer must be compressed by gzip: {error}") from None
            chunk = self._gzip.unconsumed_tail

    @property
    def ended(self) -> bool:
        """Whether the body is complete."""
        return self._gzip is None or self._gzip.eof


class Body:
    """The body of a response, collected chunk by chunk.

    Args:
        response: The response, whose body has not been read.
        most_bytes: The most bytes that it may have, decompressed.
        seconds: The time that it may take to arrive, beyond that for its length.
    """

    def __init__(self, response: httpx.Response, most_bytes: int, seconds: float) -> None:
        self._response = response
        self._decoder = Decoder(response)
        self._most_bytes = most_bytes
        self._until = time.monotonic() + seconds
        self._content = bytearray()

    def feed(self, chunk: bytes) -> None:
        """Add a chunk as it came.

        Raises:
            UnexpectedAnswer: The body is too long, or its encoding is wrong.
            httpx.ReadTimeout: It takes too long.
        """
        for piece in self._decoder.decoded(chunk):
            self._content += piece
            if len(self._content) > self._most_bytes:
                demand = f"answer must have at most {self._most_bytes} bytes"
                raise UnexpectedAnswer(f"{demand}, got more")
        if time.monotonic() > self._until + len(self._content) / _LEAST_PACE:
            raise httpx.ReadTimeout("the answer takes too long to arrive")

    def response(self) -> httpx.Response:
        """Return the response with its content, after all chunks."""
        if not self._decoder.ended:
            raise UnexpectedAnswer("answer must be compressed by gzip, got a part of it")
        headers = [
            (name, value)
            for name, value in self._response.headers.multi_items()
            if name not in ("content-encoding", "content-length", "transfer-encoding")
        ]
        return httpx.Response(
            self._response.status_code,
            headers=headers,
            content=bytes(self._content),
            request=self._response.request,
        )


def answer_of(response: httpx.Response) -> Members:
    """Return the members of the JSON object that a response holds.

    Raises:
        UnexpectedAnswer: It does not hold a JSON object.
    """
    content_type = response.headers.get("content-type", "").partition(";")[0].strip().lower()
    if content_type and not content_type.endswith("json"):
        start = f"{content_type!r:.80} with {response.content[:60]!r}"
        raise UnexpectedAnswer(f"answer must be JSON, got {start}")
    return parse_json(response.content, "answer")
