"""An estimate of the seconds that a call of a network takes, corrected by each call."""

import math
from typing import NamedTuple

from service.instance import Kind

_SLOWER = 1.5  # by how much a call that was ended raises the estimate
_FORGOTTEN = 0.95  # each time that nothing fits; else one slow hour would end all calls for good


class _Formula(NamedTuple):
    """The seconds of a call: least + each (k + first) n^power, for k preferences of n cities."""

    least: float
    each: float
    power: float
    first: float


# Of pa-one and pa-one-matrix: one thread of a 2.5 GHz Xeon, up to 1000 cities and 100 preferences.
_FORMULAS: dict[Kind, _Formula] = {
    "coordinates": _Formula(0.001, 2.2e-6, 1.25, 4.0),
    "matrices": _Formula(0.004, 3.0e-8, 2.0, 60.0),
}


class CallEstimate:
    """An estimate of the seconds of a network's calls, corrected by each call.

    Args:
        inputs: The kind of instance that the network reads.
    """

    def __init__(self, inputs: Kind) -> None:
        self._formula = _FORMULAS[inputs]
        self._factor = 1.0  # of this network on this machine, against the formula

    def seconds(self, n: int, k: int) -> float:
        """Return the estimate for n cities and k preferences."""
        least, each, power, first = self._formula
        return self._factor * (least + each * (k + first) * n**power)

    def fitting(self, n: int, seconds: float) -> int:
        """Return the greatest number of preferences whose call is estimated to take so long."""
        least, each, power, first = self._formula
        fitting = math.floor((seconds / self._factor - least) / (each * n**power) - first)
        if fitting < 1:
            self._factor = max(min(self._factor, 1.0), _FORGOTTEN * self._factor)
        return max(fitting, 0)

    def correct(self, n: int, k: int, seconds: float) -> None:
        """Correct the estimate by a call that took so many seconds."""
        self._factor *= math.sqrt(seconds / self.seconds(n, k))

    def correct_ended(self) -> None:
        """Correct the estimate by a call that was ended."""
        self._factor *= _SLOWER
