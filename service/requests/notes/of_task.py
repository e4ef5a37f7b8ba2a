"""Add notes to a task that was parsed, whichever kind it is of."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from service.fleet.fleet import LAYERS
from service.requests.notes.costs import notes_on_costs
from service.requests.notes.note import Note
from service.requests.notes.places import doubtful_places
from service.requests.notes.prizes import notes_on_prizes
from service.requests.stops import Matrix, Slices, Stops, base_of
from service.requests.task import Task, UnmeasuredFleet

_MOST = 20


def with_notes(task: Task, *, has_parts: bool = True) -> Task:
    """Return a task with notes on its stops and costs.

    Args:
        has_parts: Whether the request has all stops and costs as parts, to which notes can point.
    """
    stops = task.stops
    if stops is None:
        return task
    notes = [*_on_places(task, stops), *_on_costs(task, stops), *_on_prizes(task)][:_MOST]
    if not has_parts:
        notes = [replace(note, pointer=None) for note in notes]
    return replace(task, notes=tuple(notes)) if notes else task


def _on_places(task: Task, stops: Stops) -> Iterator[Note]:
    located = np.flatnonzero(np.isfinite(stops.locations).all(axis=1))
    if task.labels is None or not len(located):
        return
    names = [task.labels.stops[at].id for at in located.tolist()]
    for code, text, at in doubtful_places(names, stops.locations[located]):
        one = len(at) == 1
        yield Note(code, text, f"/stops/{located[at[0]]}/location" if one else "/stops")


def _on_costs(task: Task, stops: Stops) -> Iterator[Note]:
    for number, source in enumerate(stops.sources):
        m = number % LAYERS if isinstance(task.subject, UnmeasuredFleet) else number
        name, pointer = f"matrix {m}", f"/matrices/{m}"
        if task.labels is not None:
            name, pointer = repr(task.labels.objectives[m].name), f"/objectives/{m}"
        base = base_of(source)
        if isinstance(base, Matrix | Slices):
            for text in notes_on_costs(base.costs, name):
                yield Note("large-costs", text, pointer)


def _on_prizes(task: Task) -> Iterator[Note]:
    subject, labels = task.subject, task.labels
    if isinstance(subject, UnmeasuredFleet) and labels is not None and not subject.driven:
        names = [stop.id for stop in labels.stops]
        cost = labels.objectives[0].name
        for text in notes_on_prizes(subject.rules, subject.stops, names, cost):
            yield Note("prizes", text, "/stops")
