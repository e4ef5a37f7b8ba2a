"""A file that is being read, its bounds and errors; and the result: a request with notes."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from types import MappingProxyType
from typing import Annotated, Any, Literal

from paretour.members import CoverageRequest, FleetRequest, FrontRequest
from pydantic import Field

from service.errors import Fault
from service.errors import faults as faults_
from service.errors.printable import printable
from service.files.work import TooMuchWork, Work

Kind = Literal["front", "fleet", "coverage"]
Request = FrontRequest | FleetRequest | CoverageRequest
_PICTURES = (b"\x89PNG", b"P5", b"P2")
_PICTURE_NAMES = (".png", ".pgm", ".jpg", ".jpeg", ".gif", ".webp", ".bmp")
LONGEST_NAME = 200  # characters of the name of a column by which it is known
_LONGEST_SHOWN = 80  # characters of a file that a sentence quotes
_OTHER_ROWS = 10  # of totals, at most
_BYTES = 64  # of XML that are unpacked or parsed for one unit of work
MOST_WRONG = 1000  # cells; a table with more of them is not read any further


@dataclass(frozen=True, kw_only=True)
class Bounds:
    """The bounds on the content of a file and of its request.

    Args:
        cities: The most cities in planes, or stops.
        matrix_cities: The most cities with a matrix of costs.
        cells: The most fields of a table, or cells of a map.
        roads: Whether times by road can be asked for.
        profiles: The profiles of vehicles by which they can be.
    """

    cities: int = 100_000
    matrix_cities: int = 1000
    cells: int = 2**22
    roads: bool = False
    profiles: tuple[str, ...] = ()


@dataclass(frozen=True)
class NamedFile:
    """A file: its name, without folders, and its content.

    `chosen` are fields by the names of columns, which a person has chosen for them; `chosen_in` are
    those of further sheets of a spreadsheet, by `FILE [SHEET]`.
    """

    name: str
    data: bytes
    chosen: Mapping[str, str] = field(default_factory=dict)
    chosen_in: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    @property
    def is_picture(self) -> bool:
        """Whether it is PNG or PGM by its first bytes, or another picture by its name."""
        return self.data.startswith(_PICTURES) or self._ends_with(_PICTURE_NAMES)

    @property
    def is_yaml(self) -> bool:
        """Whether it is YAML, by its name."""
        return self._ends_with((".yaml", ".yml"))

    def _ends_with(self, endings: tuple[str, ...]) -> bool:
        return self.name.casefold().endswith(endings)


@dataclass(frozen=True)
class NoteItem:
    """One assumption about the files."""

    file: str
    text: str
    code: Annotated[str, Field(description="tells notes apart")]


@dataclass(frozen=True)
class ColumnItem:
    """A column of a table."""

    file: str
    name: str
    taken_for: Annotated[
        str, Field(description="a field of stops or vehicles, or `detail`, or `ignored`")
    ]


@dataclass(frozen=True)
class DetailItem:
    """A column that is not used for planning, but tells drivers something, as a phone number."""

    column: Annotated[str, Field(description="its name in the file")]
    texts: Annotated[
        list[str],
        Field(
            description='of each stop of the request, in its order; "" where there is none. At most'
            " 200 characters each"
        ),
    ]


class UnreadableFile(ValueError):
    """A file that does not follow its format, or whose format is not supported.

    Attributes:
        faults: What is wrong, one thing or more.
        columns: What the columns of tables were taken for, as far as they were read.
        choices: What they may be taken for instead, by file.
    """

    columns: Sequence[ColumnItem] = ()
    choices: Mapping[str, Sequence[str]] = MappingProxyType({})

    def __init__(self, *faults: Fault, least: str = "") -> None:
        self.faults = faults
        more = f" (and {least}{len(faults) - 1} more)" if len(faults) > 1 else ""
        super().__init__(f"{faults[0].detail}{more}")


class WrongCell(UnreadableFile):
    """Cells of tables that cannot be read. A source keeps each, so that reading can go on."""


class FileTooLarge(UnreadableFile):
    """A file with more content than its bounds allow."""


@dataclass(frozen=True)
class Reading:
    """A request, its kind, and notes on what was assumed.

    `choices` are the fields that the columns of each table may be taken for, by its file.
    """

    kind: Kind
    request: Request
    name: str
    notes: tuple[NoteItem, ...] = ()
    columns: tuple[ColumnItem, ...] = ()
    choices: Mapping[str, Sequence[str]] = field(default_factory=dict)
    planes: list[list[float]] | None = None  # rows of x, y, x, y, if distances are to be rounded
    unknown_cells: list[list[int]] | None = None  # of a map: rows of 0, and 1 where it is unknown
    details: tuple[DetailItem, ...] = ()

    @property
    def document(self) -> Mapping[str, Any]:
        """The reading as members of JSON. The request may hold arrays."""
        listed = [asdict(each) for each in self.columns]
        columns = {"columns": listed, "choices": self.choices} if listed else {}
        notes = [asdict(note) for note in self.notes]
        members = {"kind": self.kind, "request": self.request, "notes": notes}
        planes = {} if self.planes is None else {"planes": self.planes}
        unknown = {} if self.unknown_cells is None else {"unknown_cells": self.unknown_cells}
        details = {"details": [asdict(each) for each in self.details]} if self.details else {}
        return {**members, **columns, **details, **planes, **unknown, "name": self.name}


@dataclass
class Signs:
    """What is known of the decimal signs of a table.

    Args:
        separator: What separates its fields; None for white space, XLSX and JSON.
        own: The decimal signs that its numbers have for certain.
        of_request: The decimal signs of all files of the request.
    """

    separator: str | None = None
    own: set[str] = field(default_factory=set)
    of_request: set[str] = field(default_factory=set)


@dataclass(frozen=True)
class Source:
    """A file that is being read, and the notes and columns found so far.

    `work` is the budget of all files of its request.
    """

    file: NamedFile
    bounds: Bounds
    work: Work = field(default_factory=Work)
    rows: list[tuple[int, list[str]]] | None = None  # of a sheet that was read
    notes: list[NoteItem] = field(default_factory=list)
    columns: list[ColumnItem] = field(default_factory=list)
    choices: list[str] = field(default_factory=list)  # fields that its columns may be taken for
    supposed: list[ColumnItem] = field(default_factory=list)  # columns, while they are being read
    # The names of columns that are details, with their texts by the ids of stops.
    details: list[tuple[str, Mapping[str, str]]] = field(default_factory=list)
    # The faults of cells that cannot be read, by the numbers of their rows and columns.
    wrong: dict[tuple[int, int], Fault] = field(default_factory=dict)
    signs: Signs = field(default_factory=Signs)

    @property
    def name(self) -> str:
        """The file's name, harmless on a terminal."""
        return printable(self.file.name)

    def note(self, code: str, text: str) -> None:
        """Add a note on something that is assumed."""
        self.notes.append(NoteItem(self.name, printable(text), code))

    def note_once(self, code: str, begin: str, rest: str = "") -> None:
        """Add a note, unless there is one that begins alike."""
        if not any(note.text.startswith(begin) for note in self.notes):
            self.note(code, f"{begin}{rest}")

    def note_left_out(self, what: str) -> None:
        """Note something in the file that is not supported for fleets."""
        self.note("left-out", f"{what} was not used: it is not supported for fleets.")

    def fault(self, code: str, part: str = "", /, **values: object) -> Fault:
        """Return a fault of the file, or of a part of it with which the sentence begins.

        `row` and `column` among the values are the place of a row or a cell, and are its name.
        """
        if "row" in values and not part:
            part = f"row {values['row']}"
            part += f", column {quoted(values['column'])}" if "column" in values else ""
        where = f"{self.name}: {printable(part)}" if part else f"{self.name}:"
        demand = printable(faults_.said(faults_.SENTENCES[code], values))
        return Fault(code, where, values={"file": self.name, **values}, said=demand)

    def refusal(self, code: str, part: str = "", /, **values: object) -> UnreadableFile:
        """Return the exception that says what the file, or a part of it, must be."""
        return UnreadableFile(self.fault(code, part, **values))

    def refuse_cell(self, row: int, column: int, fault: Fault) -> WrongCell:
        """Keep a wrong cell, and return the exception that says what it must be.

        Only the first fault of a cell is kept.

        Raises:
            UnreadableFile: There are more wrong cells than are counted.
        """
        if len(self.wrong) >= MOST_WRONG:
            raise UnreadableFile(fault)
        self.wrong.setdefault((row, column), fault)
        return WrongCell(fault)

    def check_count(self, noun: str, limit: int, actual: int) -> None:
        """Raise FileTooLarge if the number is over the limit."""
        if actual > limit:
            raise FileTooLarge(self.fault("too-many", limit=limit, noun=noun, actual=actual))

    def of_sheet(self, title: str, rows: list[tuple[int, list[str]]]) -> "Source":
        """Return the source of the rows of a sheet; without a title, with the same name."""
        if not title:
            return replace(self, rows=rows)
        name = f"{self.file.name} [{title}]"
        file = NamedFile(name, b"", self.file.chosen_in.get(printable(name), {}))
        return Source(file, self.bounds, self.work, rows)

    def unnoted(self) -> "Source":
        """Return a source of the same file, whose notes are not told."""
        return Source(self.file, self.bounds, self.work)

    def spend(self, units: int) -> None:
        """Spend work of the budget of all files.

        Raises:
            FileTooLarge: Less is left.
        """
        try:
            self.work.spend(units)
        except TooMuchWork:
            raise self.too_much_work() from None

    def spend_on_lines(self, text: str, units: float) -> None:
        """Spend work on the lines of a text, each of these units, before it is split.

        Raises:
            FileTooLarge: Less is left.
        """
        lines = text.count("\n")
        try:
            self.work.spend(int(lines * units))
        except TooMuchWork:
            raise FileTooLarge(self.fault("too-many-lines", came=lines + 1)) from None

    def spend_on_xml(self, piece: bytes) -> None:
        """Spend work on bytes of XML that were unpacked, and on the tags in them."""
        self.spend(piece.count(b"<") + len(piece) // _BYTES)

    def too_much_work(self) -> FileTooLarge:
        """Return the exception for a file that has too much beside what a request is made of."""
        return FileTooLarge(self.fault("too-much-work"))

    def check_rows(self, count: int) -> None:
        """Raise FileTooLarge if there are more rows than stops may be, before they are read."""
        if count > self.bounds.cities + _OTHER_ROWS:
            self.check_count("stops", self.bounds.cities, count)

    def reading(self, kind: Kind, request: Request) -> Reading:
        """Return the reading of this file alone."""
        return reading_of_several(kind, request, (self,))


def reading_of_several(
    kind: Kind, request: Request, sources: Sequence[Source], planes: list[list[float]] | None = None
) -> Reading:
    """Return the reading of several files together."""
    notes = tuple(note for source in sources for note in source.notes)
    columns = tuple(column for source in sources for column in source.columns)
    name = ", ".join(source.name for source in sources)
    found = [detail for source in sources for detail in source.details]
    ids = _ids_in(request) if found else []
    details = tuple(DetailItem(each, [texts.get(i, "") for i in ids]) for each, texts in found)
    choices = choices_of(sources)
    return Reading(kind, request, name, notes, columns, choices, planes, details=details)


def check_cells(sources: Sequence[Source]) -> None:
    """Raise UnreadableFile with all wrong cells that were found in tables, if there are any."""
    cells = [fault for source in sources for _, fault in sorted(source.wrong.items())]
    if cells:
        most = max(len(source.wrong) for source in sources)
        raise WrongCell(*cells, least="at least " if most >= MOST_WRONG else "")


def _ids_in(request: Mapping[str, Any]) -> list[str]:
    """Return the ids of the stops of a request, or their numbers from 1."""
    if "stops" in request:
        return [str(stop.get("id")) for stop in request["stops"]]
    return [f"{number}" for number in range(1, len(request.get("coordinates", ())) + 1)]


def choices_of(sources: Sequence[Source]) -> dict[str, list[str]]:
    """Return the fields that the columns of each table may be taken for, by its file."""
    return {source.name: source.choices for source in sources if source.choices}


def quoted(text: object) -> str:
    """Return the beginning of a text, in quotation marks and without control characters."""
    return faults_.quoted(text, _LONGEST_SHOWN)
