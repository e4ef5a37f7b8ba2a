"""Take columns of tables for what a person has chosen, in place of what their names say."""

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Annotated

from pydantic import Field, TypeAdapter, ValidationError

from service.errors import Fault, Refusal
from service.errors.printable import printable
from service.files.reading import LONGEST_NAME, NamedFile, Source, quoted
from service.files.tables import ColumnLeftOut, Table
from service.requests.byte_order_marks import without_mark
from service.requests.fields import StrictModel, Text

IGNORED = "ignored"
DETAIL = "detail"  # not used for planning, but shown to drivers
_MOST = 1000  # columns


class ChosenColumn(StrictModel):
    """A column of a file, and the field that it is taken for, or `detail`, or `ignored`."""

    file: Text
    name: Annotated[str, Field(max_length=LONGEST_NAME)]
    taken_for: Text


_COLUMNS = TypeAdapter(Annotated[list[ChosenColumn], Field(max_length=_MOST)])


def with_chosen(files: Sequence[NamedFile], part: bytes) -> list[NamedFile]:
    """Return files with what was chosen for their columns, from a part of JSON.

    Raises:
        Refusal: The part is not a list of columns, or names a file that did not come.
    """
    try:
        columns = _COLUMNS.validate_json(without_mark(part))
    except ValidationError as error:
        wrong = error.errors(include_url=False)[0]
        place = "/".join(["columns", *map(str, wrong["loc"])])
        fault = Fault(wrong["type"].replace("_", "-"), f"{place}:", said=wrong["msg"])
        raise Refusal("invalid-parts", errors=[fault]) from None
    names = [printable(file.name) for file in files]
    sheets: dict[str, dict[str, str]] = {}
    for at, column in enumerate(columns):
        if column.file.endswith("]") and column.file.startswith(tuple(f"{n} [" for n in names)):
            sheets.setdefault(column.file, {})[column.name] = column.taken_for
        elif column.file not in names:
            fault = Fault.of(f"columns/{at}/file", "no-such-file", came=column.file)
            raise Refusal("invalid-parts", errors=[fault])
    return [
        replace(
            file,
            chosen={c.name: c.taken_for for c in columns if c.file == name},
            chosen_in=sheets,
        )
        for file, name in zip(files, names, strict=True)
    ]


def without_unused(source: Source, table: Table, fields: Collection[str]) -> Table:
    """Return a table without the columns that are chosen to be details or ignored.

    Args:
        source: The file of the table, which is told the fields that columns may be taken for.
        fields: These fields; DETAIL is among them for stops.

    Raises:
        UnreadableFile: A chosen column does not exist, is chosen for no field, or none is left.
    """
    heading = table.heading or [f"{number}" for number in range(1, table.width + 1)]
    source.choices.extend([*fields, IGNORED])
    aside = [each.name for each in table.left_out.values()]  # which are never used
    known = [each[:LONGEST_NAME] for each in (*heading, *aside)]
    for name, field in source.file.chosen.items():
        if name not in known:
            raise source.refusal("no-such-column", came=name)
        if field not in (*fields, IGNORED):
            choices = f"{', '.join(fields)} or {IGNORED}"
            part = f"column {quoted(name)}"
            raise source.refusal("not-a-choice", part, choices=choices, came=field)
    chosen = chosen_fields(source.file, heading)
    left_out = {
        at: ColumnLeftOut(heading[at], each, table.texts(at))
        for at, each in enumerate(chosen)
        if each in (DETAIL, IGNORED)
    }
    if not left_out:
        return table
    left_out |= table.left_out
    kept = [at for at in range(len(heading)) if at not in left_out]
    if not kept:
        raise source.refusal("all-ignored")
    return Table(
        [heading[at] for at in kept] if table.heading else None,
        [(number, [row[at] for at in kept]) for number, row in table.rows],
        left_out,
    )


def chosen_fields(file: NamedFile, heading: Sequence[str]) -> list[str | None]:
    """Return the field that each column of a heading was chosen for, or None."""
    return [file.chosen.get(name[:LONGEST_NAME]) for name in heading]
