"""What is stored of thousands of cities, as rows."""

from tests.benchmarks.cells import of
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load

COLUMNS = {"seconds": ".3g", "hypervolume": ".3f", "points": "d", "ends": ".4f", "peak_mb": "d"}


def scale_table() -> str:
    """Return a row for each number and shape of cities, and each way to plan."""
    rows = [
        [key, *(f"{of(entry)[0][name]:{form}}" for name, form in COLUMNS.items())]
        for key, entry in sorted(load("scale").items(), key=lambda row: _order(row[0]))
    ]
    return table(["", "seconds", "hypervolume, %", "tours", "ends", "memory, MB"], rows)


def _order(key: str) -> tuple[int, bool, str]:
    """The place of a row: by cities, uniform ones first, then as it was stored."""
    cities, shape, _ = key.split(", ", 2)
    return int(cities.partition(" ")[0]), shape != "uniform", shape
