"""What the paper has not: other shapes, networks of the literature, many cities, new tasks."""

from statistics import median
from typing import Any

from tests.benchmarks import fleet_table, growth_table, printed
from tests.benchmarks.cells import of, share_in_seconds
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load
from tests.benchmarks.scale_table import scale_table


def section() -> str:
    """What is stored of all of these."""
    large = _large() + _scale() + growth_table.section()
    return f"{_shapes()}\n{_literature()}\n{_public()}{large}{_replan()}{fleet_table.section()}"


def _shapes() -> str:
    stored = load("shapes")
    rows = dict.fromkeys(key.partition(": ")[2] for key in stored)
    groups = dict.fromkeys(key.partition(": ")[0] for key in stored)
    cells = [
        [group, *(share_in_seconds(stored.get(f"{group}: {row}")) for row in rows)]
        for group in groups
    ]
    return (
        "## Planes of other shapes\n\nNot in the paper: `python -m tests.benchmarks shapes`, the "
        "reference point n times the scale,\nthe network alone beside construction heuristics.\n\n"
        f"{table(['', *rows], cells)}"
    )


def _literature() -> str:
    stored = load("literature")
    sizes = list(printed.LITERATURE_CORNERS)
    theirs = [[row, *map("{:.2f}".format, shares)] for row, shares in printed.LITERATURE.items()]
    names = dict.fromkeys(key.partition(": ")[2] for key in stored)
    ours = [
        [name, *(share_in_seconds(stored.get(f"{n} cities: {name}")) for n in sizes)]
        for name in names
    ]
    corners = ", ".join(map(str, printed.LITERATURE_CORNERS.values()))
    counts = sorted({len(of(entry)) for entry in stored.values()})
    return (
        "## The frame of the literature\n\nNot in the paper: `python -m tests.benchmarks "
        "literature`. Uniform cities, 101 directions, in per cent of\nthe box to (r, r) with r of "
        f"{corners}. The first rows are of Chen et al. (2025), on 200\ninstances of theirs; ours "
        f"are on {' to '.join(map(str, counts))} of our own. Rows that name "
        "seconds give the network as many repairs\nas fit, or the search that time; 8 calls are "
        "those of version 0.1, each under another symmetry.\n\n"
        f"{table(['', *(f'{n} cities' for n in sizes)], [*theirs, *ours])}"
    )


def _public() -> str:
    """A row for each way to call PA-One; nothing before the first run."""
    stored = load("public")
    if not stored:
        return ""
    sizes = [(2, n) for n in printed.LITERATURE_CORNERS] + [(3, n) for n in printed.TRI_CORNERS]
    names = dict.fromkeys(key.partition(": ")[2] for key in stored)
    ours = [
        [
            name,
            *(
                share_in_seconds(stored.get(f"{m} objectives, {n} cities: {name}"))
                for m, n in sizes
            ),
        ]
        for name in names
    ]
    theirs = [
        [row, *map("{:.2f}".format, (*printed.LITERATURE[two], *printed.TRI[three]))]
        for row, (two, three) in printed.ON_PUBLIC_SETS.items()
    ]
    headings = [f"{n} cities" if m == 2 else f"{n}, three objectives" for m, n in sizes]
    return (
        "Not in the paper: `python -m tests.benchmarks public`. The same on the public sets of 200 "
        "instances, which the\nprinted rows of 20, 50 and 100 cities are of as well: under two "
        "objectives the best 101 tours of one call count,\nunder three all of them.\n\n"
        f"{table(['', *headings], [*theirs, *ours])}\n"
    )


def _large() -> str:
    rows = [
        [size, f"{of(entry)[0]['seconds']:.3g}", f"{of(entry)[0]['peak_mb']:.0f}"]
        for size, entry in load("large").items()
    ]
    return (
        "## Thousands of cities\n\nNot in the paper: `python -m tests.benchmarks large`. One "
        "inference call of PA-One with 100 preferences,\nuniform cities, one thread, each in a "
        "process of its own.\n\n"
        f"{table(['', 'seconds', 'memory at its highest, MB'], rows)}"
    )


def _scale() -> str:
    """A row for each size and shape, and way to plan; nothing before the first run."""
    if not load("scale"):
        return ""
    return (
        "\nNot in the paper: `python -m tests.benchmarks scale`. One instance a row, one thread; "
        "hypervolume in per cent of\nthe box to (n, n), and the mean of both ends over the root of "
        "n, which for an optimal tour of uniform cities\nis 0.7313 at 1,000, 0.7168 at 10,000 and "
        f"0.7124 at 100,000 (Johnson and McGeoch, 1996).\n\n{scale_table()}"
    )


def _replan() -> str:
    """A row for each kind of instance and each limit; nothing before the first run."""
    stored = load("replan")
    if not stored:
        return ""
    cells = list(next(iter(stored.values()))["instances"][0])
    ways, limits = (list(dict.fromkeys(part)) for part in zip(*map(_parts, cells), strict=True))
    rows = [
        [f"{key} ({len(of(entry))})", limit, *(_median(entry, f"{way}, {limit}") for way in ways)]
        for key, entry in stored.items()
        for limit in limits
    ]
    busy = max(entry["busy"] for entry in stored.values())
    return (
        "\n## Replanning\n\nNot in the paper: `python -m tests.benchmarks replan`. Hypervolume in "
        "the box of what 5 s from nothing\nreach, in per cent of theirs; seconds of the answer, "
        "received on loopback; the share of legs kept: medians over\nthe instances, whose number "
        f"is in brackets. At most {busy:g} programs wanted each processor.\n\n"
        f"{table(['', 'within', *ways], rows)}"
    )


def _parts(cell: str) -> tuple[str, str]:
    """The way to plan and the limit in the name of a cell, as replanned and 0.1 s."""
    way, limit = cell.split(", ")
    return way, limit


def _median(entry: dict[str, Any], column: str) -> str:
    cells = [instance[column] for instance in of(entry)]
    share, seconds = (median(cell[name] for cell in cells) for name in ("share", "seconds"))
    text = f"{100 * share:.2f} in {seconds:.3f} s"
    if "kept" not in cells[0]:
        return text
    return f"{text}, {100 * median(cell['kept'] for cell in cells):.0f} % kept"
