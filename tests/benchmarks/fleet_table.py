"""What is stored of fleets, as rows: means, and how often ours are ahead of the plain sweep."""

from typing import Any

import numpy as np

from tests.benchmarks import printed
from tests.benchmarks.cells import mean_seconds, of
from tests.benchmarks.fleet_fronts import share_of_box
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load
from tests.benchmarks.rows import Points

OURS, PLAIN = "paretour", "plain PyVRP sweep"


def section() -> str:
    """The section of the page of results; nothing before the first run."""
    stored = load("fleet")
    if not stored:
        return ""
    names = dict.fromkeys(key.partition(", ")[2] for key in stored)
    rows = [
        [name, *(_cell(stored.get(f"{n} customers, {name}")) for n in printed.FLEETS)]
        for name in names
    ]
    theirs = [
        [name, *(f"{volumes[k]:.4f}" for volumes in printed.FLEETS.values())]
        for k, name in enumerate(printed.FLEET_METHODS)
    ]
    compared = [f"{n} customers: {_comparison(stored, n)}" for n in printed.FLEETS]
    counts = sorted({len(of(entry)) for entry in stored.values()})
    return (
        "\n## Fleets\n\nNot in the paper: `python -m tests.benchmarks fleet`. Total against "
        "longest route: the hypervolume in the\nbox of the literature, with the standard error of "
        f"the mean of {' to '.join(map(str, counts))} instances; the first rows are\nprinted, of "
        "200 other instances of the recipe. Instances differ more than methods do, so methods are "
        "to be\ncompared on the same ones. In the box of our front and the plain sweep's together "
        f"the means are, and we are\nahead on: {'; '.join(compared)}.\n\n"
        f"{table(['', *(f'{n} customers' for n in printed.FLEETS)], [*theirs, *rows])}"
    )


def in_their_box(ours: list[list[float]], plain: list[list[float]]) -> tuple[float, float]:
    """The hypervolumes of two fronts in the box of both together."""
    box = np.array([*ours, *plain])
    return share_of_box(np.array(ours), box), share_of_box(np.array(plain), box)


def in_boxes(stored: dict[str, Any], n: int) -> Points:
    """Our hypervolume and the plain sweep's in each instance's box, shape (instances, 2)."""
    entries = (of(stored.get(f"{n} customers, {name}")) for name in (OURS, PLAIN))
    pairs = zip(*entries, strict=False)
    return np.array([in_their_box(ours["points"], plain["points"]) for ours, plain in pairs])


def compared(stored: dict[str, Any], n: int) -> tuple[float, float, float]:
    """The means of our front and the plain sweep's in their box, and the share where ours leads."""
    boxes = in_boxes(stored, n)
    ours, plain = boxes.mean(axis=0)
    return ours, plain, float(np.mean(boxes[:, 0] >= boxes[:, 1]))


def _comparison(stored: dict[str, Any], n: int) -> str:
    if not all(of(stored.get(f"{n} customers, {name}")) for name in (OURS, PLAIN)):
        return "not measured"
    ours, plain, ahead = compared(stored, n)
    return f"{ours:.3f} to {plain:.3f}, {100 * ahead:.0f} %"


def _cell(entry: dict[str, Any] | None) -> str:
    volumes = [each["hypervolume"] for each in of(entry)]
    if not volumes:
        return "not measured"
    error = np.std(volumes) / len(volumes) ** 0.5
    return f"{np.mean(volumes):.4f} ± {error:.4f} in {mean_seconds(entry)} s"
