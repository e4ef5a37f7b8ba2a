"""Fronts, tours and actors as text: for people, or as JSON or CSV for programs."""

import csv
import io
import json
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray
from paretour import Actor, Front, Tour
from rich.table import Table

_ENDS: Mapping[str | None, str] = {
    None: "still being planned",
    "converged": "nothing more was found",
    "time_limit": "stopped at the time limit",
    "cancelled": "stopped before its time",
}


def front_as_json(front: Front) -> str:
    """As the service answers it."""
    return json.dumps(front.document)


def front_as_csv(front: Front) -> str:
    """A line for each tour, with spaces between its cities."""
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(("angle", "length_1", "length_2", "tour"))
    for angle, lengths, tour in zip(front.angles, front.lengths, front.tours, strict=True):
        lines.writerow((float(angle), *lengths.tolist(), tour_as_text(tour)))
    return text.getvalue().rstrip()


def front_as_table(front: Front) -> Table:
    """A row for each tour, without its cities."""
    table = Table("angle", "first length", "second length")
    for column in table.columns:
        column.justify = "right"
    for angle, lengths in zip(front.angles, front.lengths, strict=True):
        table.add_row(f"{angle:.2f}", *(f"{length:.6g}" for length in lengths))
    return table


def front_in_words(front: Front) -> str:
    """What there is to say of it in a line."""
    kept = f"{len(front.tours)} of {front.points} tours found"
    bound = front.hypervolume_bound
    most = "" if bound is None else f", and no front has more than {bound:.2%}"
    return f"{kept}, hypervolume {front.hypervolume:.2%}{most}; {_ENDS[front.terminated]}"


def tour_as_json(tour: Tour) -> str:
    """As the service answers it, but for the front."""
    members = {"angle": tour.angle, "lengths": tour.lengths.tolist(), "tour": tour.tour.tolist()}
    return json.dumps(members)


def tour_as_text(tour: NDArray[np.int64]) -> str:
    """Its cities."""
    return " ".join(map(str, tour.tolist()))


def tour_in_words(tour: Tour) -> str:
    """Where it stands."""
    first, second = tour.lengths
    return f"angle {tour.angle:.2f}, lengths {first:.6g} and {second:.6g}"


def actors_as_json(actors: Iterable[Actor]) -> str:
    """As the service answers them."""
    return json.dumps({"actors": [vars(actor) for actor in actors]})


def actors_as_table(actors: Iterable[Actor]) -> Table:
    """A row for each."""
    table = Table("name", "reads", "trained on cities", "digest")
    for actor in actors:
        table.add_row(actor.name, actor.inputs, str(actor.sizes), actor.digest[:12])
    return table
