"""An estimate of the seconds that a call of a network takes, corrected by each call."""

import math
from typing import NamedTuple

from service.instance import Kind

_SLOWER = 1.5  # by how much a call that was ended raises the estimate
_FORGOTTEN = 0.95  # each time that nothing fits; else one slow hour would end all calls for good


class _Formula(NamedTuple):
    """The seconds of a call: least + each (k + first) n^power, for k preferences of n cities.

    A repair of all its tours takes repair_least + k (repair_each + repair_city n).
    """

    least: float
    each: float
    power: float
    first: float
    repair_least: float
    repair_each: float
    repair_city: float


# Of pa-one: one thread of an AMD EPYC, 100 preferences, up to 10,000 cities. Of pa-one-matrix: one
# thread of an Intel Xeon, 5 to 100 preferences, up to 1000 cities.
_FORMULAS: dict[Kind, _Formula] = {
    "coordinates": _Formula(0.001, 8.5e-6, 1.0, 4.0, 0.002, 8e-5, 2.2e-7),
    "matrices": _Formula(0.001, 9.0e-7, 1.3, 45.0, 0.001, 6.5e-5, 2.0e-7),
}


class CallEstimate:
    """An estimate of the seconds of a network's calls, corrected by each call.

    Args:
        inputs: The kind of instance that the network reads.
    """

    def __init__(self, inputs: Kind) -> None:
        self.inputs = inputs
        self._formula = _FORMULAS[inputs]
        self._factor = 1.0  # of this network on this machine, against the formula

    def seconds(self, n: int, k: int, repairs: int = 0) -> float:
        """Return the estimated seconds for n cities, k preferences and some repairs."""
        least, each, power, first, *_ = self._formula
        building = least + each * (k + first) * n**power
        return self._factor * (building + repairs * self._repair(n, k))

    def fitting(self, n: int, seconds: float) -> int:
        """Return the greatest number of preferences whose call is estimated to take so long."""
        least, each, power, first, *_ = self._formula
        fitting = math.floor((seconds / self._factor - least) / (each * n**power) - first)
        if fitting < 1:
            self._factor = max(min(self._factor, 1.0), _FORGOTTEN * self._factor)
        return max(fitting, 0)

    def fitting_repairs(self, n: int, k: int, seconds: float) -> int:
        """Return the greatest number of repairs in a call that is estimated to take so long."""
        left = seconds - self.seconds(n, k)
        return max(math.floor(left / (self._factor * self._repair(n, k))), 0)

    def correct(self, n: int, k: int, seconds: float, repairs: int = 0) -> None:
        """Correct the estimate by the seconds that a call took."""
        self._factor *= math.sqrt(seconds / self.seconds(n, k, repairs))

    def correct_ended(self) -> None:
        """Correct the estimate by a call that was ended."""
        self._factor *= _SLOWER

    def _repair(self, n: int, k: int) -> float:
        """Return the seconds of one repair by the formula."""
        *_, least, each, city = self._formula
        return least + k * (each + city * n)
