"""Repairs of first tours: how many are worth their time where a request does not say."""

from service.instance import Kind

TOURS_REPAIRED = 2  # for each preference: its tour, and another one that was found on the way

# With these, a call takes four to six times as long as without, with matrices of up to 100
# cities five to eight times, and has most of what repairs gain: `python -m tests.benchmarks
# literature`, `actors`, `asymmetric`, `behind`. A repair lays out whole tours, so it takes longer
# where there are many cities, and fewer of them are worth it.
_LEAST: dict[Kind, int] = {"coordinates": 3, "matrices": 2}
_EACH_CITY: dict[Kind, float] = {"coordinates": 0.45, "matrices": 1 / 3}  # of few
# Under more than two objectives repairs gain more: `python -m tests.benchmarks tri`.
_EACH_CITY_UNDER_SEVERAL: dict[Kind, float] = {"coordinates": 0.65, "matrices": 1 / 3}
# Of many: these, and cities for each one more.
_FIRST: dict[Kind, int] = {"coordinates": 80, "matrices": 20}
_CITIES_OF_MANY: dict[Kind, int] = {"coordinates": 70, "matrices": 40}
_MOST: dict[Kind, int] = {"coordinates": 150, "matrices": 75}


def repairs_worth(inputs: Kind, n: int, objectives: int) -> int:
    """Return how many repairs of tours of n cities are worth their time.

    Args:
        inputs: The kind of instance that the network reads.

    >>> [repairs_worth("coordinates", n, objectives=2) for n in (20, 200, 1000, 5000)]
    [9, 82, 94, 150]
    >>> [repairs_worth("coordinates", n, objectives=3) for n in (20, 200, 1000, 5000)]
    [13, 82, 94, 150]
    """
    each_city = _EACH_CITY if objectives == 2 else _EACH_CITY_UNDER_SEVERAL
    of_few = int(each_city[inputs] * n)
    of_many = _FIRST[inputs] + n // _CITIES_OF_MANY[inputs]
    return max(_LEAST[inputs], min(of_few, of_many, _MOST[inputs]))
