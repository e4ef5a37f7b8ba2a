"""Read files that came over HTTP, within the limits of a service, as JSON."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any, NamedTuple

from pydantic_core import to_json

from service.actor_info import ActorInfo
from service.errors import Refusal
from service.files.chosen import with_chosen
from service.files.maps import with_grid
from service.files.reader import read_files
from service.files.reading import Bounds, FileTooLarge, NamedFile, UnreadableFile
from service.files.spreadsheets import is_spreadsheet
from service.requests.limits import Limits, check_structure

_CELL_BYTES = 8  # bytes per field, if a body were full of fields


def bounds_of(limits: Limits) -> Bounds:
    """Return the bounds of files that a service can plan."""
    return Bounds(
        cities=limits.cities,
        matrix_cities=limits.matrix_cities,
        cells=max(limits.cells, limits.body_bytes // _CELL_BYTES),
        roads=limits.roads,
    )


class Upload(NamedTuple):
    """Files, and what was chosen for their columns, as JSON."""

    files: Sequence[NamedFile]
    columns: bytes | None

    @property
    def length(self) -> int:
        """The bytes of all."""
        return sum(len(file.data) for file in self.files) + len(self.columns or b"")


class _Unreadable(Refusal):
    """Files that cannot be read, with what their columns were taken for."""

    code = "unreadable-file"

    def __init__(self, error: UnreadableFile) -> None:
        super().__init__(detail=str(error))
        columns = [asdict(column) for column in error.columns]
        self.members = {"columns": columns, "choices": error.choices} if columns else {}

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
        raise Refusal("file-too-large", detail=str(error)) from None
    except UnreadableFile as error:
        raise _Unreadable(error) from None
    answer = to_json(reading.document, inf_nan_mode="null")
    if len(answer) > limits.body_bytes:
        detail = f"{reading.name}: must become a request of at most {limits.body_bytes} bytes"
        raise Refusal("file-too-large", detail=f"{detail}, got {len(answer)}")
    return answer
