"""Read one file or several. The content of a file tells its format; if not, the end of its name."""

from collections.abc import Sequence
from itertools import chain

from paretour.member_parts import ObjectiveRequest
from paretour.members import FrontRequest

from service.errors import Fault
from service.files.benchmarks.customers import is_customers, read_customers
from service.files.benchmarks.cvrp import read_cvrp
from service.files.benchmarks.keywords import check_costs, is_fleet
from service.files.columns import share_signs
from service.files.fleets import Stop
from service.files.json_files.reader import looks_like_json, read_json
from service.files.maps.octile import is_octile
from service.files.other_files import STOPS, named_binary
from service.files.reading import (
    Bounds,
    FileTooLarge,
    Kind,
    NamedFile,
    Reading,
    Source,
    UnreadableFile,
    check_cells,
    choices_of,
    reading_of_several,
)
from service.files.stop_tables import FilePart, part_of, reading_of
from service.files.tables import Table, table_of_csv, table_of_rows
from service.files.texts import text_of
from service.files.tsplib import (
    TsplibFile,
    costs,
    is_tsplib,
    note_rounded,
    places,
    plain,
    split_tsplib,
)
from service.files.vehicle_tables import has_places, has_vehicles, read_fleet
from service.files.waypoints import is_xml, table_of_xml
from service.files.work import LINE_OF_TEXT, UNITS, Work
from service.files.xlsx.sheets import is_spreadsheet, sheets_of
from service.objectives import MOST_OBJECTIVES, NTH, OBJECTIVES

_UNITS_OF_STOP = 16  # of work, where there may be more stops than usual


def read_files(
    files: Sequence[NamedFile],
    bounds: Bounds,
    *,
    wanted: Kind | None = "front",
    unrounded: bool = False,
) -> Reading:
    """Return the request in a file, in a file for each objective, or in stops and vehicles.

    Args:
        files: The files in the order of their objectives; or stops, then vehicles.
        bounds: The most that they may hold.
        wanted: The kind of a request that does not show its own kind; None refuses such a request.
        unrounded: Whether EUC_2D of TSPLIB means planes, not rounded distances.

    Raises:
        UnreadableFile: A file is not of a known format, or is wrong; the message names it.
    """
    work = Work(max(UNITS, _UNITS_OF_STOP * bounds.cities))
    sources = [Source(file, bounds, work) for file in files]
    try:
        sources = [sheet for each in sources for sheet in _sheets(each, several=len(files) > 1)]
        return _read_cells(sources, wanted, unrounded)
    except UnreadableFile as error:
        error.columns = [column for source in sources for column in source.supposed]
        error.choices = choices_of(sources)
        raise


def _sheets(source: Source, *, several: bool) -> list[Source]:
    """Return a file, or in place of a spreadsheet those of its sheets that are read."""
    return sheets_of(source, several=several) if is_spreadsheet(source.file.data) else [source]


def _read_cells(sources: Sequence[Source], wanted: Kind | None, unrounded: bool) -> Reading:
    """Return the request of files; where cells of tables are wrong, raise all of them together."""
    try:
        reading = _read_all(sources, wanted, unrounded)
    except FileTooLarge:
        raise
    except UnreadableFile:
        check_cells(sources)  # what else is wrong may follow from them
        raise
    check_cells(sources)
    return reading


def _read_all(sources: Sequence[Source], wanted: Kind | None, unrounded: bool) -> Reading:
    files = [source.file for source in sources]
    if any(map(_is_map, files)):
        return _read_map(sources)
    if len(sources) == 1:
        return _read(sources[0], wanted)
    if not OBJECTIVES <= len(sources) <= MOST_OBJECTIVES:
        raise _of_files("number-of-files", most=MOST_OBJECTIVES, came=len(files))
    return _read_several(sources, wanted, unrounded)


def _read_map(sources: Sequence[Source]) -> Reading:
    """Return the request for a map, in a picture or more, a map.yaml and tables of costs."""
    from service.files.maps.reader import read_map  # here because it is slow to load

    maps = [each for each in sources if _is_map(each.file)]
    tables = [each for each in sources if each not in maps]
    return read_map(maps, [(each, _table(each)) for each in tables])


def _is_map(file: NamedFile) -> bool:
    return file.is_picture or file.is_yaml or is_octile(file.data)


def _read_several(sources: Sequence[Source], wanted: Kind | None, unrounded: bool) -> Reading:
    """Return the request in a file for each objective, or in one of stops and one of vehicles."""
    contents = [(source, _content(source)) for source in sources]
    tables = [(source, each) for source, each in contents if isinstance(each, Table)]
    share_signs(tables)
    if wanted == "fleet" and not len(tables) == len(sources) == 2:
        raise _of_files("files-of-fleet")
    if len(tables) == len(sources) == 2 and (
        wanted == "fleet" or any(has_vehicles(each) for _, each in tables)
    ):
        stops, vehicles = sorted(tables, key=lambda each: has_vehicles(each[1]))
        return read_fleet(stops, vehicles)
    parts = [_part(source, each, unrounded) for source, each in contents]
    request = _joined(parts)
    known = [part.plane for part in parts if part.plane]
    # The page draws the planes behind rounded distances of two objectives alone.
    planes = _side_by_side(known) if len(known) == len(parts) == OBJECTIVES else None
    return reading_of_several("front", request, sources, planes)


def _read(source: Source, wanted: Kind | None) -> Reading:
    """Return the request in a file that holds both objectives, or a fleet, or a map."""
    content = _content(source)
    if isinstance(content, Table):
        if has_vehicles(content) and not has_places(content):
            raise source.refusal("vehicles-alone")
        return reading_of(source, content)
    if isinstance(content, TsplibFile):
        if is_fleet(content):
            return read_cvrp(content)
        check_costs(content)
        raise source.refusal("one-objective")
    if is_customers(content):
        return read_customers(source, content)
    return read_json(source, content, wanted)


def read_table(file: NamedFile, bounds: Bounds) -> tuple[Source, Table]:
    """Return the table in CSV or XLSX, and its source.

    Raises:
        UnreadableFile: The file is not a table; the message names it.
    """
    [source] = _sheets(Source(file, bounds), several=True)
    return source, _table(source)


def _table(source: Source) -> Table:
    content = _content(source)
    if not isinstance(content, Table):
        raise source.refusal("not-a-table")
    return content


def _content(source: Source) -> Table | TsplibFile | str:
    """Return a table, a file of TSPLIB, or the text of JSON or of customers with windows."""
    if source.rows is not None:
        return table_of_rows(source, source.rows)
    if (named := named_binary(source.file.data)) is not None:
        raise source.refusal("another-format", wanted=STOPS, given=named)
    if is_xml(source.file.data):
        return table_of_xml(source)
    text = text_of(source)
    if looks_like_json(text):
        return text
    source.spend_on_lines(text, LINE_OF_TEXT)
    if is_tsplib(text):
        return split_tsplib(source, text)
    if is_customers(text) or source.name.casefold().endswith((".json", ".geojson")):
        return text
    return table_of_csv(source, text)


def _part(source: Source, file: Table | TsplibFile | str, unrounded: bool) -> FilePart:
    """Return the content of one of several files."""
    if isinstance(file, Table):
        return part_of(source, file)
    if isinstance(file, str):
        raise source.refusal("not-one-of-several")
    check_costs(file)
    if unrounded:
        if file.kind != "EUC_2D":
            raise source.refusal("not-planes", "EDGE_WEIGHT_TYPE", given=file.kind)
        return FilePart(source.name, file.dimension, coordinates=places(file).tolist())
    found = costs(file)
    note_rounded(file)
    plane = places(file).tolist() if file.kind == "EUC_2D" else None
    return FilePart(source.name, len(found), matrix=plain(found), plane=plane)


def _joined(parts: Sequence[FilePart]) -> FrontRequest:
    """Return the request of files about the same stops, one for each objective."""
    first = parts[0]
    for part in parts:
        if part.count != first.count:
            came = f"{first.count} of {first.name} and {part.count} of {part.name}"
            raise _of_files("other-number-of-stops", given=came)
    ids = next((part.ids for part in parts if part.ids), None)
    if any(part.ids and part.ids != ids for part in parts):
        raise _of_files("other-ids")
    located = [part.stops for part in parts if part.stops]
    if len(located) > 1:
        raise _of_files("two-with-places")
    matrices = [part.matrix for part in parts if part.matrix is not None]
    if not ids and len(matrices) == len(parts):
        return {"matrices": matrices}
    coordinates = [part.coordinates for part in parts if part.coordinates is not None]
    if not ids and len(coordinates) == len(parts):
        return {"coordinates": _side_by_side(coordinates)}
    names = [part.name.rpartition(".")[0][:80] or part.name[:80] for part in parts]
    if len(set(names)) < len(names):
        names = [f"{nth} length" for nth in NTH[: len(parts)]]
    objectives = [_objective(name, part) for name, part in zip(names, parts, strict=True)]
    named: list[Stop] = [{"id": each} for each in ids or map(str, range(1, first.count + 1))]
    return {"stops": located[0] if located else named, "objectives": objectives}


def _objective(name: str, part: FilePart) -> ObjectiveRequest:
    if part.matrix is not None:
        return {"name": name, "matrix": part.matrix}
    if part.coordinates is not None:
        return {"name": name, "coordinates": part.coordinates}
    return {"name": name, "from": "great_circle"}


def _of_files(code: str, **values: object) -> UnreadableFile:
    """Return the exception that says what several files together must be."""
    return UnreadableFile(Fault(code, values=values))


def _side_by_side(planes: Sequence[list[list[float]]]) -> list[list[float]]:
    """Return the places of each stop in all planes as one row."""
    return [list(chain.from_iterable(each)) for each in zip(*planes, strict=True)]
