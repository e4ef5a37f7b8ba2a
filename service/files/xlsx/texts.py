"""Read the texts that the cells of a workbook of XLSX share."""

from xml.parsers import expat

from service.files.xlsx.package import local


class TextsReader:
    """The handlers of the tags of shared texts: each has one or several runs.

    Attributes:
        parser: The parser that calls the handlers.
        texts: The texts, without how they are pronounced.
    """

    def __init__(self) -> None:
        self.texts: list[str] = []
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self._pieces: list[str] = []
        self._phonetic = 0

    def _start(self, tag: str, _: dict[str, str]) -> None:
        name = local(tag)
        if name == "si":
            self._pieces.clear()
        elif name == "rPh":
            self._phonetic += 1
        elif name == "t" and not self._phonetic:
            self.parser.CharacterDataHandler = self._pieces.append

    def _end(self, tag: str) -> None:
        name = local(tag)
        if name == "t":
            self.parser.CharacterDataHandler = None
        elif name == "rPh":
            self._phonetic -= 1
        elif name == "si":
            self.texts.append("".join(self._pieces))
