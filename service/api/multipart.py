"""Bodies of several parts (RFC 7578), held in memory: they are no longer than a body may be."""

from collections.abc import Collection
from math import inf

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import Field, File, FormParser, parse_options_header

from service.errors import Refusal


def parts(content_type: str, body: bytes, expected: Collection[str]) -> dict[str, bytes]:
    """The content of each part by its name: all of those expected, once each, and no other.

    Raises:
        Refusal: it is not of parts, or of others.
    """
    reader = _Reader(expected)
    _, options = parse_options_header(content_type)
    try:
        parser = FormParser(
            "multipart/form-data",
            reader.take_field,
            reader.take_file,
            reader.end,
            options.get(b"boundary"),
            config={"MAX_MEMORY_FILE_SIZE": inf},
        )
        parser.write(body)
        parser.finalize()
    except FormParserError as error:
        raise _malformed(str(error)) from None
    if not reader.ended:
        raise _malformed("it ends before its last boundary")
    if missing := [name for name in expected if name not in reader.found]:
        raise _unexpected(f"the part {missing[0]} is required")
    return reader.found


class _Reader:
    """Takes the parts as they come."""

    def __init__(self, expected: Collection[str]) -> None:
        self.found: dict[str, bytes] = {}
        self.ended = False
        self._expected = expected

    def take_field(self, part: Field) -> None:
        self._take(part.field_name, part.value)

    def take_file(self, part: File) -> None:
        part.file_object.seek(0)
        self._take(part.field_name, part.file_object.read())

    def end(self) -> None:
        self.ended = True

    def _take(self, raw: bytes | None, content: bytes | None) -> None:
        name = (raw or b"").decode(errors="replace")
        if name not in self._expected or name in self.found:
            among = " and ".join(self._expected)
            raise _unexpected(f"the parts must be {among}, once each, got {name[:80]!r}")
        self.found[name] = content or b""


def _malformed(reason: str) -> Refusal:
    return Refusal(400, "malformed-multipart", f"the body must be multipart/form-data: {reason}")


def _unexpected(sentence: str) -> Refusal:
    return Refusal(422, "invalid-parts", sentence)
