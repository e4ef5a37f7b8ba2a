"""The local search for an instance, behind one interface: by three-opt where that finds more."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from service.objectives import OBJECTIVES
from service.search import working_tour
from service.search.candidates import Scalarization
from service.search.local_search import NO_END, iterated_local_search
from service.search.sizes import LARGE, MENDING, THREE_OPT
from service.search.state import SearchState
from service.search.three_opt import local_search as three_opt
from service.search.three_opt import undoable_tour
from service.search.three_opt.undoable_tour import make_undoable_tour
from service.search.working_tour import QueuedTour, UndoableTour, WorkingTour

Cities = NDArray[np.int32]

EFFORT = 3  # of an iteration by three-opt, which takes three or four times as long as by two-opt
OFFERED = 2_000  # cities up to which every local optimum is offered; beyond, proportionally fewer


class LocalSearch(Protocol):
    """A local search from a working tour, which offers what it finds to an archive."""

    @property
    def working(self) -> QueuedTour:
        """The tour that it changes."""

    @property
    def effort(self) -> int:
        """The number of the schedule's iterations that one of its own counts as."""

    def load(self, tour: Cities, first: float, second: float) -> None:
        """Replace the working tour by another of known lengths, with an empty queue."""

    def descend(self, scalarization: Scalarization, budget: int) -> int:
        """Make improving moves; return the rest of the budget of cities, 0 if more may follow."""

    def iterate(self, scalarization: Scalarization, steps: int) -> None:
        """Perturb and descend `steps` times, each time returning to the better tour."""


def choose_local_searches(state: SearchState, mending: bool) -> tuple[LocalSearch, LocalSearch]:
    """Return the local searches for the instance of a state: for descents, and for iterations.

    With `mending` they set out from the tours of an earlier front.

    Of fewer cities than LARGE a descent by two-opt is over sooner; iterations mend what it left.
    """
    n, symmetric = len(state.costs.cities), state.costs.symmetric
    several = len(state.archive.lengths) > OBJECTIVES
    two_opt = TwoOptSearch(state, offer_all=several)
    if symmetric and n < (MENDING if mending else THREE_OPT):
        return two_opt, two_opt
    effort = 1 if symmetric and n >= LARGE else EFFORT
    every = NO_END if several else max(1, n // OFFERED)
    three_opt = ThreeOptSearch(state, make_undoable_tour(n), every, effort)
    return two_opt if n < LARGE else three_opt, three_opt


@dataclass(frozen=True)
class TwoOptSearch:
    """A local search by 2-opt and Or-opt, or where costs are asymmetric by swaps of blocks."""

    state: SearchState
    offer_all: bool  # or else the local optima that iterations reach
    effort: int = 1

    @property
    def working(self) -> WorkingTour:
        """The tour that it changes."""
        return self.state.working

    def load(self, tour: Cities, first: float, second: float) -> None:
        """Replace the working tour."""
        working_tour.load(self.working, tour, first, second)

    def descend(self, scalarization: Scalarization, budget: int) -> int:
        """Make improving moves."""
        return iterated_local_search(self.state, scalarization, 0, budget, False)

    def iterate(self, scalarization: Scalarization, steps: int) -> None:
        """Perturb and descend."""
        iterated_local_search(self.state, scalarization, steps, NO_END, self.offer_all)


@dataclass(frozen=True)
class ThreeOptSearch:
    """A local search by exchanges of two to five steps, or where costs are asymmetric of 3 to 7."""

    state: SearchState
    working: UndoableTour
    every: int  # of the local optima that iterations reach, one is offered
    effort: int = 1

    def load(self, tour: Cities, first: float, second: float) -> None:
        """Replace the working tour."""
        undoable_tour.load(self.working, tour, first, second)

    def descend(self, scalarization: Scalarization, budget: int) -> int:
        """Make improving exchanges."""
        return three_opt.descend(self.working, scalarization, budget, False)

    def iterate(self, scalarization: Scalarization, steps: int) -> None:
        """Perturb and descend."""
        three_opt.iterated_local_search(self.state, self.working, scalarization, steps, self.every)
