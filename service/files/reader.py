"""Read one file or two. The content of a file tells its format; if not, the end of its name."""

from collections.abc import Sequence

from service.files.benchmarks import is_customers, is_cvrp, read_customers, read_cvrp
from service.files.json_files import looks_like_json, read_json
from service.files.reading import (
    Bounds,
    Kind,
    NamedFile,
    Reading,
    Request,
    Source,
    UnreadableFile,
    reading_of_both,
)
from service.files.spreadsheets import is_spreadsheet, rows_of
from service.files.stop_tables import Part, part_of, reading_of
from service.files.tables import Table, table_of, table_of_csv
from service.files.texts import text_of
from service.files.tsplib import TsplibFile, costs, is_tsplib, places, plain, split_tsplib
from service.files.vehicle_tables import has_vehicles, read_fleet

_BINARY = {
    b"%PDF": "a PDF",
    b"\xd0\xcf\x11\xe0": "an old spreadsheet (.xls): save it as .xlsx or CSV",
    b"\x1f\x8b": "a gzip file: unpack it first",
    b"PAR1": "a Parquet file: save it as CSV",
    b"\x93NUMPY": "a NumPy file: send it as the part `matrices` of POST /front",
}


def read_files(
    files: Sequence[NamedFile],
    bounds: Bounds,
    *,
    wanted: Kind | None = "front",
    unrounded: bool = False,
) -> Reading:
    """Return the request in a file, or in two files of an objective each, or of stops and vehicles.

    Args:
        files: The files in the order of their objectives; or stops, then vehicles.
        bounds: The most that they may hold.
        wanted: The kind of a request that does not show its own kind; None refuses such a request.
        unrounded: Whether EUC_2D of TSPLIB means planes, not rounded distances.

    Raises:
        UnreadableFile: A file is not of a known format, or is wrong; the message names it.
    """
    sources = [Source(file, bounds) for file in files]
    if any(file.is_picture or file.is_yaml for file in files):
        from service.files.maps import read_map  # here because it is slow to load

        return read_map(sources)
    if len(sources) == 1:
        return _read(sources[0], wanted)
    if len(sources) != 2:
        raise UnreadableFile(f"there must be one file or two, got {len(files)}")
    return _read_two(sources, wanted, unrounded)


def _read_two(sources: Sequence[Source], wanted: Kind | None, unrounded: bool) -> Reading:
    """Return the request in two files of an objective each, or of stops and vehicles."""
    contents = [(source, _content(source)) for source in sources]
    tables = [(source, each) for source, each in contents if isinstance(each, Table)]
    if wanted == "fleet" and len(tables) != 2:
        raise UnreadableFile("two files of a fleet must be a table of stops and one of vehicles")
    if len(tables) == 2 and (wanted == "fleet" or any(has_vehicles(each) for _, each in tables)):
        stops, vehicles = sorted(tables, key=lambda each: has_vehicles(each[1]))
        return read_fleet(stops, vehicles)
    first, second = (_part(source, each, unrounded) for source, each in contents)
    planes = None
    if first.plane and second.plane:
        planes = [[*one, *other] for one, other in zip(first.plane, second.plane, strict=True)]
    return reading_of_both("front", _joined(first, second), sources, planes)


def _read(source: Source, wanted: Kind | None) -> Reading:
    """Return the request in a file that holds both objectives, or a fleet, or a map."""
    content = _content(source)
    if isinstance(content, Table):
        return reading_of(source, content)
    if isinstance(content, TsplibFile):
        if is_cvrp(content):
            return read_cvrp(content)
        raise source.refusal("a file of TSPLIB is one objective: name another for the other one")
    if is_customers(content):
        return read_customers(source, content)
    return read_json(source, content, wanted)


def read_table(file: NamedFile, bounds: Bounds) -> tuple[Source, Table]:
    """Return the table in CSV or XLSX, and its source.

    Raises:
        UnreadableFile: The file is not a table; the message names it.
    """
    source = Source(file, bounds)
    content = _content(source)
    if not isinstance(content, Table):
        raise source.refusal("must be a table, in CSV or XLSX")
    return source, content


def _content(source: Source) -> Table | TsplibFile | str:
    """Return a table, a file of TSPLIB, or the text of JSON or of customers with windows."""
    if is_spreadsheet(source.file.data):
        return table_of(source, rows_of(source))
    for begin, named in _BINARY.items():
        if source.file.data.startswith(begin):
            raise source.refusal(f"must be a file of stops, got {named}")
    text = text_of(source)
    if looks_like_json(text):
        return text
    if is_tsplib(text):
        return split_tsplib(source, text)
    if is_customers(text) or source.name.casefold().endswith((".json", ".geojson")):
        return text
    return table_of_csv(source, text)


def _part(source: Source, file: Table | TsplibFile | str, unrounded: bool) -> Part:
    """Return the content of one of two files."""
    if isinstance(file, Table):
        return part_of(source, file)
    if isinstance(file, str):
        raise source.refusal("must be a table or TSPLIB, as one of two files")
    if unrounded:
        if file.kind != "EUC_2D":
            raise source.refusal(f"EDGE_WEIGHT_TYPE must be EUC_2D, got {file.kind}")
        return Part(source.name, file.dimension, None, {"coordinates": places(file).tolist()})
    found = costs(file)
    if file.kind != "EXPLICIT":
        source.note("rounded", f"Distances are whole numbers, as TSPLIB defines {file.kind}.")
    plane = places(file).tolist() if file.kind == "EUC_2D" else None
    return Part(source.name, len(found), None, {"matrix": plain(found)}, plane=plane)


def _joined(first: Part, second: Part) -> Request:
    """Return the request of two files about the same stops.

    Raises:
        UnreadableFile: Their stops differ, or both say where stops lie.
    """
    if first.count != second.count:
        came = f"{first.count} of {first.name} and {second.count} of {second.name}"
        raise UnreadableFile(f"both files must have the same number of stops, got {came}")
    if first.ids and second.ids and first.ids != second.ids:
        raise UnreadableFile("both files must have the same ids, in the same order")
    ids = first.ids or second.ids
    located = first.stops or second.stops
    if first.stops and second.stops:
        raise UnreadableFile("only one of the two files may have longitudes and latitudes")
    if not ids and first.costs.keys() == second.costs.keys():
        if "matrix" in first.costs:
            return {"matrices": [first.costs["matrix"], second.costs["matrix"]]}
        planes = zip(first.costs["coordinates"], second.costs["coordinates"], strict=True)
        return {"coordinates": [[*one, *other] for one, other in planes]}
    names = [part.name.rpartition(".")[0][:80] or part.name[:80] for part in (first, second)]
    if names[0] == names[1]:
        names = ["first length", "second length"]
    objectives = [
        {"name": name, **(part.costs or {"from": "great_circle"})}
        for name, part in zip(names, (first, second), strict=True)
    ]
    stops = located or [{"id": each} for each in ids or map(str, range(1, first.count + 1))]
    return {"stops": stops, "objectives": objectives}
