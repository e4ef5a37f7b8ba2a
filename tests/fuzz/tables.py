"""Mutated tables, and a judge that counts their rows and columns by a reader of its own.

What the reader of files takes must hold every row, and say of each column what it was used for.
"""

import csv
import io
import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile

Grid = list[list[str]]
UNUSED = ("detail", "ignored")
_TIMES = ("service", "due", "release", "prize", "skills", "vehicle")
_MEMBERS = {**{each: (each,) for each in _TIMES}, "window": ("window", "windows")}
_SEPARATORS = (",", ",", ";", "\t", "|")
TEMPLATES = (
    "id,lat,lon,demand,from,to,service (min),note\n"
    "depot,60.1710,24.9410,,08:00,18:00,,\nA1,60.1690,24.9520,2,09:00,12:00,5,ring\n"
    "A2,60.1650,24.9330,1,,,5,\nA3,60.1800,24.9250,3,10:00,11:30,10,back door\n",
    "name,city,latitude,longitude\nAnn,Espoo,60.17,24.94\nBo,Espoo,60.18,24.95\nCy,Vantaa,60.16,24.93\n",
    "id,x1,y1,x2,y2\na,0.5,1.5,3,4\nb,5,6,7.25,8\nc,1,9,3,3\nd,4,4,8,1\n",
    "0.12,0.55,0.91,0.33\n0.97,0.05,0.42,0.78\n0.3,0.61,0.08,0.4\n",
    "60.171,24.941,0,0\n60.169,24.952,2,300\n60.165,24.933,3,600\n",
    "id,lat,lon,weight\ndepot,60.171,24.941,0\na,60.169,24.952,1250\nb,60.165,24.933,900\n",
    "Order ID,Latitude,Longitude,Duration,Load #1,Time window from,Time window to\n"
    "1,60.171,24.941,10,1,08:00,12:00\n2,60.169,24.952,15,2,,\n3,60.165,24.933,5,1,09:00,17:00\n",
    "customer,x,y,demand,ready,due\n0,0,0,0,0,100\n1,3,4,2,10,40\n2,6,8,1,20,60\n",
    "id,lat,lon,risk,skills,deadline\na,60.171,24.941,1,,\nb,60.169,24.952,2,fridge,2026-11-30\n",
    "WKT,name,prize\nPOINT (24.941 60.171),Ann,3\nPOINT (24.952 60.169),Bo,4\n",
)
VANS = "vehicle,count,capacity,shift start,shift end\nvan,2,4,08:00,16:00\nbike,1,2,09:00,13:00\n"
_HEADINGS = (
    *("City", "Name", "id", "price", "Duration", "service", "lat", "lon", "x", "y", "x2", "y2", ""),
    *("demand", "Order Weight", "from", "to", "window", "due", "release", "cost", "phone", "Total"),
    *("Earliest Time", "Latest Time", "point", "Location", "type", "prize", "driver", "1", "0"),
)
_CELLS = (
    *("", "0", "1", "7", "-3", "2.5", "1,250", "1.250", "1.234,5", "60.171", "0:10", "08:00-12:00"),
    *(
        "8",
        "25:00",
        "2026-11-30",
        "2026-12-01T10:00:00Z",
        "30.11.2026",
        "n/a",
        "Total",
        "depot",
        "a",
    ),
    *("Ann", "5 min", "1e3", "x", "POINT (24.9 60.2)", "60.1, 24.9", "90000000"),
)


@dataclass(frozen=True)
class Files:
    """Mutated files, each with its grid and what separates its fields."""

    grids: tuple[Grid, ...]
    separator: str

    @property
    def named(self) -> list[NamedFile]:
        """The files as they are brought."""
        return [
            NamedFile(f"{at}.csv", _written(grid, self.separator).encode())
            for at, grid in enumerate(self.grids)
        ]


def mutated_tables(seed: int) -> Files:
    """Return a table, or one with a table of vehicles, with up to five mutations."""
    rng = random.Random(f"tables {seed}")
    grids = [_grid(rng.choice(TEMPLATES))]
    if rng.random() < 0.2:
        grids.append(_grid(VANS))
    for _ in range(rng.randint(0, 5)):
        _mutate(rng, rng.choice(grids))
    return Files(tuple(grids), rng.choice(_SEPARATORS))


def _grid(text: str) -> Grid:
    return [list(row) for row in csv.reader(io.StringIO(text))]


def _written(grid: Grid, separator: str) -> str:
    out = io.StringIO()
    csv.writer(out, delimiter=separator, lineterminator="\n").writerows(grid)
    return out.getvalue()


def _mutate(rng: random.Random, grid: Grid) -> None:
    """Change a table as people do."""
    if len(grid) > 2 and len(grid[0]) > 1:
        rng.choice((*_OF_CELLS, *_OF_COLUMNS, *_OF_ROWS))(rng, grid)


def _rename(rng: random.Random, grid: Grid) -> None:
    grid[0][rng.randrange(len(grid[0]))] = rng.choice(_HEADINGS)


def _change(rng: random.Random, grid: Grid) -> None:
    rng.choice(grid)[rng.randrange(len(grid[0]))] = rng.choice(_CELLS)


def _swap(rng: random.Random, grid: Grid) -> None:
    first, second = rng.randrange(len(grid[0])), rng.randrange(len(grid[0]))
    for row in grid:
        row[first], row[second] = row[second], row[first]


def _drop(rng: random.Random, grid: Grid) -> None:
    at = rng.randrange(len(grid[0]))
    for row in grid:
        del row[at]


def _add_texts(rng: random.Random, grid: Grid) -> None:
    _add(rng, grid, rng.choices(_CELLS, k=len(grid) - 1))


def _add_numbers(rng: random.Random, grid: Grid) -> None:
    _add(rng, grid, [f"{rng.randrange(900)}" for _ in grid[1:]])


def _add(rng: random.Random, grid: Grid, cells: list[str]) -> None:
    at = rng.randrange(len(grid[0]) + 1)
    for row, cell in zip(grid, [rng.choice(_HEADINGS), *cells], strict=True):
        row.insert(at, cell)


def _repeat(rng: random.Random, grid: Grid) -> None:
    grid.insert(rng.randrange(len(grid) + 1), [*rng.choice(grid)])


def _insert_empty(rng: random.Random, grid: Grid) -> None:
    grid.insert(rng.randrange(1, len(grid) + 1), [""] * len(grid[0]))


def _add_total(rng: random.Random, grid: Grid) -> None:
    total = [""] * len(grid[0])
    total[0] = rng.choice(("Total", "", "A9"))
    total[rng.randrange(len(total))] = rng.choice(("6", "2150", ""))
    grid.append(total)


def _remove(rng: random.Random, grid: Grid) -> None:
    del grid[rng.choice((0, rng.randrange(len(grid))))]


_OF_CELLS = (_rename, _change, _change)
_OF_COLUMNS = (_swap, _drop, _add_texts, _add_numbers)
_OF_ROWS = (_repeat, _insert_empty, _add_total, _remove)


def judged(seed: int) -> tuple[str, list[str]]:
    """Return what becomes of mutated tables, `read` or `refused`, and what is wrong with it."""
    files = mutated_tables(seed)
    try:
        reading = read_files(files.named, Bounds(), wanted=None)
    except UnreadableFile as error:
        named = any(str(error).startswith(f"{each.name}: ") for each in files.named)
        named |= "files" in str(error)
        return "refused", [] if named else [f"names no file: {error}"]
    return "read", list(_faults(files, reading))


def tried(count: int) -> tuple[Counter[str], list[str]]:
    """Return how many of many mutated tables were read and refused, and all faults."""
    outcomes: Counter[str] = Counter()
    faults = []
    for seed in range(count):
        outcome, wrong = judged(seed)
        outcomes[outcome] += 1
        faults += [f"{seed}: {each}" for each in wrong]
    return outcomes, faults


def _faults(files: Files, reading: Reading) -> list[str]:
    """Return each row that vanished, and each column whose use is not said or not true."""
    texts = {each.name: each.data.decode() for each in files.named}
    if reading.kind == "front" and len(texts) > 1:
        return []  # planes or matrices from files of their own
    faults: list[str] = []
    for number, (name, text) in enumerate(texts.items()):
        filled = [
            row for row in csv.reader(io.StringIO(text), delimiter=files.separator) if any(row)
        ]
        listed = [each for each in reading.columns if each.file == name]
        names = [each.name for each in listed]
        heading = [row for row in filled if [cell.strip() for cell in row] == names]
        notes = [note.text for note in reading.notes if note.file == name]
        data = filled[filled.index(heading[0]) + 1 :] if heading else filled
        if any("below the heading" in note for note in notes):
            data = filled[2:]  # below two rows of headings
        left_out = sum(" was taken for a total and left out" in note for note in notes)
        planned = _planned(reading, of_vehicles=number > 0)
        if planned + left_out != len(data):
            faults.append(f"{len(data)} rows became {planned}, {left_out} left out: {notes}")
        above = filled.index(heading[0]) if heading else 0
        if above and not any("heading" in note for note in notes):
            faults.append(f"{above} rows above the heading vanished")
        faults += _of_columns(reading, listed, notes, len(filled[0]))
        if listed and not number and planned == len(data) and "stops" in reading.request:
            faults += _of_members(reading, [each.taken_for for each in listed], data)
    return faults


def _planned(reading: Reading, *, of_vehicles: bool) -> int:
    """Return how many rows of a table are in the request; not the stops that were added."""
    request = reading.request
    if of_vehicles:
        return len(request["vehicles"])
    if "stops" not in request:
        return len(request["coordinates"])
    return sum(not each["id"].endswith("(depot)") for each in request["stops"])


def _of_columns(
    reading: Reading, listed: Sequence[Any], notes: Sequence[str], width: int
) -> list[str]:
    """Return faults of what is said about columns."""
    if not listed:
        request = reading.request
        used = len(request.get("coordinates", [[]])[0])
        if "stops" in request:
            planes = sum("coordinates" in each for each in request["objectives"])
            used = 1 + 2 * planes if planes else width * ("location" in request["stops"][0])
        return [] if used == width else [f"{used} of {width} columns were used, none is named"]
    told = "".join(note for note in notes if note.startswith("Columns were taken for"))
    unused = told.partition("Not used:")[2]
    faults = [] if len(listed) == width else [f"{len(listed)} of {width} columns are told"]
    faults += [
        f"{each.name!r} is {each.taken_for}, and not said to be"
        for each in listed
        if (each.taken_for in UNUSED) != (repr(each.name) in unused)
        and sum(other.name == each.name for other in listed) == 1
    ]
    return faults


def _of_members(reading: Reading, taken: Sequence[str], data: Grid) -> list[str]:
    """Return faults of members that fewer stops have than rows have fields."""
    stops = [
        each for each in reading.request.get("stops", ()) if not each["id"].endswith("(depot)")
    ]
    vehicles = reading.request.get("vehicles", ())
    depots = {each.get(end) for each in vehicles for end in ("start", "end")}
    depots |= {stop for each in vehicles for stop in each.get("reload", ())}
    said = " ".join(note.text for note in reading.notes if note.code in ("depot", "left-out"))
    faults = []
    for field, members in _MEMBERS.items():
        columns = [at for at, each in enumerate(taken) if each.split("_")[0] == field]
        for stop, row in zip(stops, data, strict=True):
            cells = [row[at].strip() for at in columns if at < len(row)]
            has = any(member in stop for member in members)
            if (
                any(cells)
                and not has
                and not (stop["id"] in depots and _is_lost(stop, cells, reading, said))
            ):
                faults.append(f"{stop['id']!r} lost its {field} {cells}")
    demands = taken.count("demand")
    if demands and any(len(each["demand"]) != demands for each in stops if "demand" in each):
        faults.append("a demand is not in the stops")
    return faults


def _is_lost(stop: Any, cells: Sequence[str], reading: Reading, said: str) -> bool:
    """Return whether what a depot lost is nothing, is told, or has become a shift."""
    told = repr(stop["id"]) in said or all(not cell.strip("0:. ") for cell in cells)
    return told or any("shift" in each or "shifts" in each for each in reading.request["vehicles"])
