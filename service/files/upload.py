"""Read files that came over HTTP, within the limits of a service, as JSON."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from operator import mul
from typing import Any, NamedTuple

from pydantic_core import to_json

from service.actor_info import ActorInfo
from service.errors import Fault, Refusal
from service.files.chosen import DETAIL, IGNORED, with_chosen
from service.files.maps.reader import with_grid
from service.files.reader import read_files
from service.files.reading import (
    Bounds,
    FileTooLarge,
    NamedFile,
    NoteItem,
    Reading,
    UnreadableFile,
    WrongCell,
)
from service.files.xlsx.sheets import is_spreadsheet
from service.requests.limits import Limits, check_structure

_UNPACKED = 50  # times the bytes of a spreadsheet; the usual are some 10 times as long
_CELL_BYTES = 8  # bytes per field, if a body were full of fields


def bounds_of(limits: Limits) -> Bounds:
    """Return the bounds of files that a service can plan."""
    return Bounds(
        cities=limits.cities,
        matrix_cities=limits.matrix_cities,
        cells=max(limits.cells, limits.body_bytes // _CELL_BYTES),
        roads=limits.roads,
        profiles=limits.profiles,
    )


class Upload(NamedTuple):
    """Files, and what was chosen for their columns, as JSON."""

    files: Sequence[NamedFile]
    columns: bytes | None

    @property
    def weight(self) -> int:
        """The bytes of all as long as they may be to read: spreadsheets are compressed."""
        times = [_UNPACKED if is_spreadsheet(file.data) else 1 for file in self.files]
        lengths = [len(file.data) for file in self.files]
        return sum(map(mul, lengths, times)) + len(self.columns or b"")


class _Unreadable(Refusal):
    """Files that cannot be read, with what their columns were taken for."""

    code = "unreadable-file"

    def __init__(self, error: UnreadableFile) -> None:
        super().__init__(detail=str(error), errors=error.faults)
        columns = [asdict(column) for column in error.columns]
        self.members: dict[str, Any] = (
            {"columns": columns, "choices": error.choices} if columns else {}
        )
        if isinstance(error, WrongCell):
            self.members["wrong_cells"] = len(error.faults)

    def document(self, request_id: str) -> dict[str, Any]:
        return {**super().document(request_id), **self.members}


def read_upload(upload: Upload, limits: Limits, actors: Mapping[str, ActorInfo]) -> bytes:
    """Return the document of a reading as JSON.

    Raises:
        Refusal: A file cannot be read, or it or its request is too large.
    """
    del actors  # not needed here, only for planning
    files = upload.files
    if upload.columns is not None:
        check_structure(upload.columns, limits)
        files = with_chosen(files, upload.columns)
    for file in files:
        if not is_spreadsheet(file.data):  # the bytes of a spreadsheet are compressed
            check_structure(file.data, limits)
    try:
        reading = read_files(files, bounds_of(limits), wanted=None)
        if reading.kind == "coverage":  # a client that shows the map needs a grid
            reading = with_grid(reading, limits.cells)
    except FileTooLarge as error:
        raise Refusal("file-too-large", errors=error.faults) from None
    except UnreadableFile as error:
        raise _Unreadable(error) from None
    return _json(reading, limits.body_bytes)


def _json(reading: Reading, most_bytes: int) -> bytes:
    """Return a reading as JSON, without its details if it would be too long with them."""
    answer = to_json(reading.document, inf_nan_mode="null")
    if len(answer) > most_bytes and reading.details:
        return _json(_without_details(reading), most_bytes)
    if len(answer) > most_bytes:
        counts = {"limit": most_bytes, "actual": len(answer)}
        fault = Fault("too-long-request", f"{reading.name}:", values=counts)
        raise Refusal("file-too-large", errors=[fault])
    return answer


def _without_details(reading: Reading) -> Reading:
    """Return a reading whose details are ignored, with a note: they are too long for an answer."""
    columns = [
        replace(each, taken_for=IGNORED) if each.taken_for == DETAIL else each
        for each in reading.columns
    ]
    text = "The columns for drivers were left out: they are too long. Ignore some of them."
    note = NoteItem(reading.name, text, "details")
    return replace(reading, details=(), columns=tuple(columns), notes=(*reading.notes, note))
