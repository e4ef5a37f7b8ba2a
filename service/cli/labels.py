"""The names of both lengths and of all stops in what the command prints and draws."""

from paretour import FleetFront, Front, RobotFront

from service.cli.inputs import Ids
from service.cli.terminal_chart import LABELS

AnyFront = Front | FleetFront | RobotFront


def labels_of(front: AnyFront) -> tuple[str, ...]:
    """Return the label of either length: the name of its objective with the unit, if it has any."""
    if front.objectives is None:
        return LABELS
    return tuple(
        each.name if each.unit is None else f"{each.name} ({each.unit})"
        for each in front.objectives
    )


def columns_of(front: Front) -> tuple[str, ...]:
    """Return the headings of both lengths in a table for other programs."""
    return ("length_1", "length_2") if front.objectives is None else labels_of(front)


def lengths_as_text(front: AnyFront, lengths: tuple[float, float]) -> str:
    """Return both lengths of a tour as the end of a sentence, with names and units if any."""
    first, second = (f"{length:.6g}" for length in lengths)
    if front.objectives is None:
        return f"lengths {first} and {second}"
    return ", ".join(
        " ".join(filter(None, (each.name, length, each.unit)))
        for each, length in zip(front.objectives, (first, second), strict=True)
    )


def ids_of(front: Front) -> Ids | None:
    """Return the id of each stop, by its index; None where the request had none."""
    stops = front.document.get("stops")
    return None if stops is None else tuple(stop["id"] for stop in stops)
