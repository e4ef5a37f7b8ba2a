"""Split a multipart/form-data body into its parts, in time that is linear in its length.

The whole body is in memory, so searching for boundaries is fast. Everything except the contents is
bounded: the boundary, the headers of a part and the number of parts.
"""

import re
from collections.abc import Collection, Iterator
from typing import NamedTuple

from python_multipart.multipart import parse_options_header

from service.errors import Fault, Refusal
from service.errors.faults import shorten

_LONGEST_BOUNDARY = 70  # bytes (RFC 2046)
_LONGEST_HEADERS = 4096  # bytes of all headers of one part
_LONGEST_FILENAME = 200  # characters
_MOST_FILES = 8
_NAMES = (b"name", b"filename")
_PIECE = 2**20  # bytes that are searched at once, which takes ten milliseconds at most
_BREAK = b"\r\n"


def split_parts(content_type: str, body: bytes, expected: Collection[str]) -> dict[str, bytes]:
    """Return the content of each part of a multipart/form-data body by the part's name.

    Raises:
        Refusal: The body is malformed, or does not have each expected part once.
    """
    contents: dict[str, bytes] = {}
    for name, content, _ in _parts(_delimiter(content_type), body):
        if name not in expected or name in contents:
            raise _invalid("other-parts", among=" and ".join(expected), given=shorten(name))
        contents[name] = content
    if missing := [name for name in expected if name not in contents]:
        raise _invalid("no-part", name=missing[0])
    return contents


class Files(NamedTuple):
    """The name and the content of each file of a form, in order, and its part `columns`."""

    files: list[tuple[str, bytes]]
    columns: bytes | None


def split_files(content_type: str, body: bytes) -> Files:
    """Return the files of a multipart/form-data body.

    Each is a part `file` with a filename; one part may be named `columns`.

    Raises:
        Refusal: The body is malformed, or has other parts or too many.
    """
    files: list[tuple[str, bytes]] = []
    columns: bytes | None = None
    for name, content, filename in _parts(_delimiter(content_type), body):
        if name == "columns" and columns is None:
            columns = content
            continue
        if name != "file" or not filename:
            raise _invalid("no-file-part", given=shorten(name))
        if len(files) == _MOST_FILES:
            raise _invalid("too-many-parts", limit=_MOST_FILES)
        files.append((filename, content))
    if not files:
        raise _invalid("no-part", name="file")
    return Files(files, columns)


def _delimiter(content_type: str) -> bytes:
    _, options = parse_options_header(content_type)
    boundary = options.get(b"boundary", b"")
    if not 0 < len(boundary) <= _LONGEST_BOUNDARY:
        demand = f"Content-Type must name a boundary of 1 to {_LONGEST_BOUNDARY} bytes"
        raise _malformed(f"{demand}, got {len(boundary)}")
    return b"--" + boundary


def _parts(delimiter: bytes, body: bytes) -> Iterator[tuple[str, bytes, str]]:
    """Yield the name, the content and the filename of each part, in order."""
    at = body.startswith(_BREAK) * len(_BREAK)
    if not body.startswith(delimiter, at):
        raise _malformed("it must begin with its boundary")
    at += len(delimiter)
    while not body.startswith(b"--", at):
        if not body.startswith(_BREAK, at):
            raise _malformed("a line break must follow each boundary")
        begin = at + len(_BREAK)
        end = body.find(2 * _BREAK, begin, begin + _LONGEST_HEADERS)
        if end < 0:
            raise _malformed(f"a part must have headers of at most {_LONGEST_HEADERS} bytes")
        name, filename = _names(body[begin:end])
        content = end + 2 * len(_BREAK)
        next_one = _find(_BREAK + delimiter, body, content)
        yield name, body[content:next_one], filename
        at = next_one + len(_BREAK + delimiter)


def _find(delimiter: bytes, body: bytes, start: int) -> int:
    """Return where a delimiter is, searched piece by piece, so that other threads have turns."""
    for begin in range(start, len(body), _PIECE):
        found = body.find(delimiter, begin, begin + _PIECE + len(delimiter) - 1)
        if found >= 0:
            return found
    raise _malformed("it ends before its last boundary")


def _names(headers: bytes) -> tuple[str, str]:
    """Return the name of a part with these headers, and the filename without folders."""
    for line in headers.split(_BREAK):
        header, _, value = line.partition(b":")
        if header.strip().lower() == b"content-disposition":
            _, options = parse_options_header(value)
            name, path = (options.get(key, b"").decode(errors="replace") for key in _NAMES)
            return name, re.split(r"[\\/]", path)[-1][:_LONGEST_FILENAME]
    return "", ""


def _malformed(reason: str) -> Refusal:
    return Refusal("malformed-multipart", reason=reason)


def _invalid(code: str, **values: object) -> Refusal:
    return Refusal("invalid-parts", errors=[Fault(code, values=values)])
