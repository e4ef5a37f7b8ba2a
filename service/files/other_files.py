"""Recognise files that are not read, by their content, and say what to do with them."""

BINARY = {
    b"%PDF": "a PDF",
    b"\xd0\xcf\x11\xe0": "an old spreadsheet (.xls): save it as .xlsx or CSV",
    b"\t\x08\x10\x00": "an old spreadsheet (.xls): save it as .xlsx or CSV",
    b"\x1f\x8b": "a gzip file: unpack it first",
    b"7z\xbc\xaf": "a 7z file: unpack it first",
    b"Rar!": "a RAR file: unpack it first",
    b"PAR1": "a Parquet file: save it as CSV",
    b"SQLite format 3": "a GeoPackage or another SQLite file: export it as GeoJSON or CSV",
    b"\x00\x00\x27\x0a": "a shapefile: export it as GeoJSON",
    b"\x93NUMPY": "a NumPy file: send it as the part `matrices` of POST /front",
}
_LOCKED = "EncryptedPackage".encode("utf-16-le")  # as Excel writes an XLSX with a password
STOPS = "a file of stops"
# What it must be, and what it is, by the name of the first element in small letters.
XML = {
    "html": (STOPS, "a web page: download the file itself, or save it as CSV"),
    "table": (STOPS, "a table of a web page: save it as XLSX or CSV"),
    "workbook": ("XLSX", "a spreadsheet in XML: save it as XLSX or CSV"),
    "document": ("XLSX", "an OpenDocument spreadsheet (.fods): save it as XLSX or CSV"),
    "osm": (STOPS, "data of OpenStreetMap: export its points as GeoJSON"),
    "featurecollection": ("GeoJSON", "GML: export it as GeoJSON"),
    "trainingcenterdatabase": ("GPX", "TCX: export its places as GPX"),
}


def named_binary(data: bytes) -> str | None:
    """Return what kind of binary file these bytes are, and what to do; None if they are not one."""
    if data.startswith(b"\xd0\xcf\x11\xe0") and _LOCKED in data:
        return "a spreadsheet with a password: save it without one"
    return next((named for begin, named in BINARY.items() if data.startswith(begin)), None)
