"""Read the rows of a spreadsheet in XLSX, from its first visible sheet with content."""

import io
import zipfile
from datetime import datetime, time
from typing import Any

from service.files.reading import FileTooLarge, Source

_MOST_BYTES = 2**27  # in all parts together, unpacked
_MOST_PARTS = 2000


def is_spreadsheet(data: bytes) -> bool:
    """Return whether bytes are a zip file, which XLSX is."""
    return data.startswith(b"PK\x03\x04")


def rows_of(source: Source) -> list[list[str]]:
    """Return the fields of each row, as text.

    Raises:
        UnreadableFile: It is not XLSX, has no row, or is too large unpacked.
    """
    _check_size(source)
    import openpyxl

    try:
        book = openpyxl.load_workbook(
            io.BytesIO(source.file.data), read_only=True, data_only=True, keep_links=False
        )
        sheets = [sheet for sheet in book.worksheets if sheet.sheet_state == "visible"]
        return _first_with_rows(source, sheets)
    except FileTooLarge:
        raise
    except Exception as error:  # a damaged part may raise any exception
        if isinstance(error, MemoryError):
            raise
        raise source.refusal(f"must be XLSX: {type(error).__name__}") from None


def _check_size(source: Source) -> None:
    """Raise a refusal if a zip file is too large unpacked; no part can be larger than it says."""
    try:
        parts = zipfile.ZipFile(io.BytesIO(source.file.data)).infolist()
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
        raise source.refusal(f"must be XLSX: {error}") from None
    source.check_count("parts", _MOST_PARTS, len(parts))
    source.check_count("bytes unpacked", _MOST_BYTES, sum(part.file_size for part in parts))
    if not any(part.filename.endswith("workbook.xml") for part in parts):
        raise source.refusal("must be XLSX, got another zip file: unpack it first")


def _first_with_rows(source: Source, sheets: list[Any]) -> list[list[str]]:
    """Return the rows of the first sheet that has any, and note that there are others."""
    for sheet in sheets:
        sheet.reset_dimensions()  # wrong dimensions would cut rows, and huge ones lengthen them
        rows: list[list[str]] = []
        count = 0
        for row in sheet.iter_rows(values_only=True):
            count += 1 + len(row)
            source.check_count("fields and rows", source.bounds.cells, count)
            rows.append([_text(value) for value in row])
        if any(any(row) for row in rows):
            if len(sheets) > 1:
                source.note("sheet", f"Only the sheet {sheet.title!r} of {len(sheets)} was read.")
            width = max(map(len, rows))  # each row ends at its last field with content
            source.check_count("fields", source.bounds.cells, width * len(rows))
            return [row + [""] * (width - len(row)) for row in rows]
    return []


def _text(value: Any) -> str:
    """Return the value of a cell as the text of a field in CSV."""
    if value is None:
        return ""
    if isinstance(value, time | datetime):
        return value.isoformat(sep=" ") if isinstance(value, datetime) else value.isoformat()
    if isinstance(value, float) and value.is_integer() and abs(value) < 2**53:
        return str(int(value))
    return str(value)
