"""Read files that came over HTTP, within the limits of a service, as JSON."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from pydantic_core import to_json

from service.actor_info import ActorInfo
from service.errors import Refusal
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


def read_upload(
    files: Sequence[NamedFile], limits: Limits, actors: Mapping[str, ActorInfo]
) -> bytes:
    """Return the document of a reading as JSON.

    Raises:
        Refusal: A file cannot be read, or it or its request is too large.
    """
    del actors  # not needed here, only for planning
    for file in files:
        if not is_spreadsheet(file.data):  # the bytes of a spreadsheet are compressed
            check_structure(file.data, limits)
    try:
        reading = read_files(files, bounds_of(limits), wanted=None)
        if reading.kind == "coverage":  # a client that shows the map needs a grid
            request = with_grid(reading.name, reading.request, limits.cells)
            reading = replace(reading, request=request)
    except FileTooLarge as error:
        raise Refusal("file-too-large", detail=str(error)) from None
    except UnreadableFile as error:
        raise Refusal("unreadable-file", detail=str(error)) from None
    answer = to_json(reading.document, inf_nan_mode="null")
    if len(answer) > limits.body_bytes:
        detail = f"{reading.name}: must become a request of at most {limits.body_bytes} bytes"
        raise Refusal("file-too-large", detail=f"{detail}, got {len(answer)}")
    return answer
