"""Take byte order marks off JSON, which programs of Windows write, so that it is plain UTF-8."""

import codecs

_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)  # that of UTF-32 begins like the first


def without_mark(body: bytes) -> bytes:
    """Return a body as UTF-8 without a mark; unchanged if it has none, or does not fit its mark.

    >>> without_mark(codecs.BOM_UTF8 + b"[1]")
    b'[1]'
    >>> without_mark("[1]".encode("utf-16"))
    b'[1]'
    """
    if body.startswith(codecs.BOM_UTF8):
        return body[len(codecs.BOM_UTF8) :]
    if not body.startswith(_UTF_16):
        return body
    try:
        return body.decode("utf-32" if body.startswith(codecs.BOM_UTF32_LE) else "utf-16").encode()
    except UnicodeError:
        return body
