"""Read XML element by element, without entities, within the budget of work of its file."""

from collections.abc import Callable, Collection, Iterator
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from service.files.reading import Source, UnreadableFile

_PIECE = 2**14  # bytes that are parsed at once
_LONGEST_TAG = 2**17  # bytes: expat keeps a tag whole
_DEEPEST = 50

Wanted = Callable[[str], Collection[str]]
Read = Callable[[int], bytes]


def elements(
    source: Source, read: Read, wanted: Wanted, doctype: Callable[[str], UnreadableFile]
) -> Iterator[Element]:
    """Yield each wanted element with all that is in it, once it has ended; nothing else is kept.

    Names are those without prefixes, apart from the names of attributes.

    Args:
        source: The file, whose budget is spent.
        read: Returns the next bytes, at most so many; none at the end.
        wanted: Returns the names of the elements to yield, given the name of the outermost one.
        doctype: Returns the exception for a document type, given its name. It is never read, as
            its entities could grow without end.

    Raises:
        UnreadableFile: It takes too much work, a tag is too long, or elements are too deep.
        expat.ExpatError: It is not XML.
    """
    builder = _Builder(source, wanted)
    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.add_text

    def refuse(name: str, *_: object) -> None:
        raise doctype(name)

    parser.StartDoctypeDeclHandler = refuse
    fed = 0
    while piece := read(_PIECE):
        source.spend_on_xml(piece)
        parser.Parse(piece)
        fed += len(piece)
        # Expat begins again at the start of a tag or comment with each piece.
        if fed - parser.CurrentByteIndex > _LONGEST_TAG:
            raise source.too_much_work()
        yield from builder.take()
    parser.Parse(b"", True)
    yield from builder.take()


class _Builder:
    """Builds the wanted elements of a document while it is parsed."""

    def __init__(self, source: Source, wanted: Wanted) -> None:
        self._source = source
        self._wanted = wanted
        self._names: Collection[str] = ()
        self._depth = 0
        self._outermost = 0  # the depth of the wanted element that is open; 0 if none is
        self._tree = TreeBuilder()
        self._whole: list[Element] = []

    def take(self) -> list[Element]:
        """Return the elements that have ended since the last call."""
        whole, self._whole = self._whole, []
        return whole

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """Begin an element."""
        name = tag.rpartition(":")[2]
        if not self._depth:
            self._names = self._wanted(name)
        self._depth += 1
        if self._depth > _DEEPEST:
            raise self._source.refusal("too-deep", most=_DEEPEST)
        if not self._outermost and name in self._names:
            self._outermost = self._depth
        if self._outermost:
            self._tree.start(name, attributes)

    def add_text(self, text: str) -> None:
        """Add text to the element that is open."""
        if self._outermost:
            self._tree.data(text)

    def end(self, tag: str) -> None:
        """End the element that is open."""
        if self._outermost:
            self._tree.end(tag)
        if self._outermost == self._depth:
            self._whole.append(self._tree.close())
            self._tree, self._outermost = TreeBuilder(), 0
        self._depth -= 1
