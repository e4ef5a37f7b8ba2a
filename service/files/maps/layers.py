"""Read the costs of the cells of a map, and name them."""

from collections.abc import Sequence

from service.files.reading import Source
from service.files.stop_tables import numbers_of
from service.files.tables import Table, number_in

Rows = Sequence[Sequence[float]]
_LONGEST = 80  # characters of a name
_TAKEN = "distance"  # the name of the first objective


def costs_of_cells(source: Source, table: Table, grid: Rows) -> Rows:
    """Return the costs in a table, which has a field for each cell of a grid.

    Fields that are not numbers, or are negative, are kept as wrong.
    """
    costs = _without_counts(source, table, grid)
    rows = numbers_of(source, costs)
    for at, row in enumerate(rows):
        negative = [column for column, cost in enumerate(row) if cost < 0] if min(row) < 0 else []
        for column in negative:
            place = {"row": at + 1, "column": column + 1}
            part = f"row {at + 1}, column {column + 1} of its costs"
            fault = source.fault("no-cost-of-cell", part, **place, came=row[column])
            source.refuse_cell(costs.rows[at][0], column, fault)
    return rows


def _without_counts(source: Source, table: Table, grid: Rows) -> Table:
    """Return the table without the numbers of rows and columns that pandas writes around it.

    A first row that counts may be costs as well. It is, if there are too few rows without it.
    """
    heading, rows = table.heading, table.rows
    if heading is None:
        return table
    if len(rows) + 1 == len(grid) and all(number_in(each) is not None for each in heading):
        source.notes[:] = [note for note in source.notes if note.code != "heading"]
        return Table(None, [(rows[0][0] - 1, heading), *rows])
    counts = [row[0] for _, row in rows] == [str(at) for at in range(len(rows))]
    if heading[0] == "" and counts and len(heading) == len(grid[0]) + 1:
        return Table(heading[1:], [(number, row[1:]) for number, row in rows])
    return table


def check_size_of_layer(source: Source, layer: Rows, grid: Rows) -> None:
    """Raise UnreadableFile where a layer has not a cost for each cell of a grid."""
    if (len(layer), len(layer[0])) != (len(grid), len(grid[0])):
        raise source.refusal("cost-each-cell", size=_size(grid), given=_size(layer))


def _size(rows: Rows) -> str:
    return f"{len(rows)} x {len(rows[0])}"


def names_of_layers(names: Sequence[str]) -> list[str]:
    """Return these names, no two of them alike, and none that of the first objective.

    >>> names_of_layers(["noise", "distance", "noise"])
    ['noise', 'distance 2', 'noise 2']
    """
    found: list[str] = []
    for name in names:
        free, number = name[:_LONGEST], 2
        while free in (_TAKEN, *found):
            free, number = f"{name[:_LONGEST]} {number}", number + 1
        found.append(free)
    return found
