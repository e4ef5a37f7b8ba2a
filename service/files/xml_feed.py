"""Parse XML piece by piece, within the budget of work of its file."""

from collections.abc import Callable
from xml.parsers import expat

from service.files.reading import Source

_PIECE = 2**14  # bytes that are parsed at once
_LONGEST_TAG = 2**17  # bytes: expat keeps a tag whole


def feed(source: Source, parser: "expat.XMLParserType", read: Callable[[int], bytes]) -> None:
    """Parse what a function reads, so many bytes at a time, until it reads none.

    Raises:
        FileTooLarge: It takes too much work, or a tag is too long.
        expat.ExpatError: It is not XML.
    """
    fed = 0
    while piece := read(_PIECE):
        source.spend_on_xml(piece)
        parser.Parse(piece)
        fed += len(piece)
        # Expat begins again at the start of a tag or comment with each piece.
        if fed - parser.CurrentByteIndex > _LONGEST_TAG:
            raise source.too_much_work()
    parser.Parse(b"", True)
