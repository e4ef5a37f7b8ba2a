"""The names of both lengths and of all stops, for printing and drawing."""

from paretour import Front, FrontOfAnyKind

from service.cli.inputs import Ids, ids_in
from service.cli.terminal_chart import LABELS
from service.errors.printable import printable


def labels_of(front: FrontOfAnyKind) -> tuple[str, ...]:
    """Return the labels of both lengths: the name of the objective, with its unit if it has one."""
    return LABELS if front.objectives is None else tuple(map(printable, _names(front)))


def _names(front: FrontOfAnyKind) -> list[str]:
    return [
        each.name if each.unit is None else f"{each.name} ({each.unit})"
        for each in front.objectives or ()
    ]


def columns_of(front: Front) -> tuple[str, ...]:
    """Return the headings of both lengths in tables that other programs read."""
    return ("length_1", "length_2") if front.objectives is None else tuple(_names(front))


def lengths_as_text(front: FrontOfAnyKind, lengths: tuple[float, float]) -> str:
    """Return both lengths of a tour, with names and units if any, as the end of a sentence."""
    first, second = (f"{length:.6g}" for length in lengths)
    if front.objectives is None:
        return f"lengths {first} and {second}"
    return ", ".join(
        printable(" ".join(filter(None, (each.name, length, each.unit))))
        for each, length in zip(front.objectives, (first, second), strict=True)
    )


def ids_of(front: Front) -> Ids | None:
    """Return the id of each stop, by its index; None if the answer does not name all stops."""
    ids = ids_in(front.document.get("stops"))
    return None if ids is None or len(ids) < front.tours.shape[1] else ids
