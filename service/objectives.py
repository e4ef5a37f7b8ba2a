"""Objectives: how many there may be, and what a caller calls them."""

from dataclasses import dataclass

OBJECTIVES = 2  # of a request that says nothing else, and of all that knows no more than two
MOST_OBJECTIVES = 4
NTH = ("first", "second", "third", "fourth")  # what one without a name is called


@dataclass(frozen=True)
class Objective:
    """The name of an objective, and its unit if the caller said so."""

    name: str
    unit: str | None = None
