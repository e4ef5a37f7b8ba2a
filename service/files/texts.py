"""Decode the bytes of a text file: UTF-8, UTF-16, or an older encoding that is guessed."""

import codecs

from service.files.reading import Source

_BOMS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
# The encodings that spreadsheets of the last decades wrote.
_LATIN = ("cp1252", "cp1250", "cp1254")
_LEGACY = [*_LATIN, "cp1251", "cp1253", "cp932", "gb18030", "big5", "cp949"]
_SAMPLE = 2**14  # bytes by which an encoding is guessed


def text_of(source: Source) -> str:
    """Return the text of a file, whose lines end as in Unix, with a note if it is not UTF-8.

    Raises:
        UnreadableFile: The bytes are not text.
    """
    data = source.file.data
    marked = next((name for bom, name in _BOMS if data.startswith(bom)), None)
    encoding = marked or _encoding_of(data)
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        raise source.refusal("not-text", encoding=encoding, byte=error.start) from None
    if "\0" in text:
        raise source.refusal("zero-bytes")
    if not encoding.startswith("utf"):
        said = f"The text was read as {encoding}, as it is not UTF-8"
        source.note("encoding", f"{said}: if letters look wrong, save the file as UTF-8.")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _encoding_of(data: bytes) -> str:
    """Return the encoding of bytes without a byte order mark."""
    even, odd = data[:_SAMPLE:2].count(0), data[1:_SAMPLE:2].count(0)
    if even + odd > min(len(data), _SAMPLE) // 4:  # every other byte of Latin text in UTF-16
        return "utf-16-le" if odd > even else "utf-16-be"
    try:
        data.decode()
    except UnicodeDecodeError as error:
        return _legacy(data, error.start)
    return "utf-8"


def _legacy(data: bytes, first: int) -> str:
    """Guess an encoding older than UTF-8; `first` is the first byte beyond ASCII."""
    from charset_normalizer import from_bytes

    begin = max(0, first - _SAMPLE // 2)
    best = from_bytes(data[begin : begin + _SAMPLE], cp_isolation=_LEGACY).best()
    # Latin encodings differ in a few characters only, too few to tell them apart in short texts.
    return "cp1252" if best is None or best.encoding in _LATIN else best.encoding
