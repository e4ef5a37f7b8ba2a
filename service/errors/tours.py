"""Refuse cities that no tour or plan can have, and name them."""

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from service.errors.exceptions import Refusal
from service.errors.faults import Fault, quoted

_MOST_NAMED = 5  # cities of one kind in one sentence
_PLURALS = {"city": "cities", "stop": "stops", "place": "places"}
_TABLE = tomllib.loads(Path(__file__).with_name("obstacles.toml").read_text(encoding="utf-8"))
_BOUNDS: Mapping[str, str] = _TABLE.pop("bounds")
OBSTACLES: Mapping[str, str] = _TABLE


@dataclass(frozen=True)
class CityNames:
    """The words by which refusals name cities.

    Args:
        noun: The word for a city, such as "stop".
        ids: The caller's names of the cities; None where there are only indexes.
        part: The member of the request that has an item for each city; None where none has.
        parts: In place of it, the part of the request that is each city, as add/0; empty where the
            request has none.
    """

    noun: str = "city"
    ids: Sequence[str] | None = None
    part: str | None = None
    parts: Sequence[str] | None = None

    def of(self, cities: Sequence[int]) -> str:
        """Return the names of some cities; of many, only the first few."""
        noun = self.noun if len(cities) == 1 else _PLURALS[self.noun]
        names = [self._name(city) for city in cities[:_MOST_NAMED]]
        if len(cities) > _MOST_NAMED:
            names.append(f"{len(cities) - _MOST_NAMED} more")
        return f"{noun} {_listed(names)}"

    def pointer(self, city: int) -> str | None:
        """Return the JSON pointer to a city in the request."""
        if self.parts is not None:
            return f"/{self.parts[city]}" if self.parts[city] else None
        return None if self.part is None else f"/{self.part}/{city}"

    def _name(self, city: int) -> str:
        return str(city) if self.ids is None else quoted(self.ids[city])


@dataclass(frozen=True)
class Obstacle:
    """A reason why every tour has a forbidden leg, or why a fleet has no plan.

    Args:
        code: One of OBSTACLES.
        cities: The cities at fault.
        others: Further cities that the sentence names.
        values: Its other values; `bounds` are names of the table `bounds`.
    """

    code: str
    cities: tuple[int, ...]
    others: tuple[int, ...] = ()
    values: Mapping[str, Any] = field(default_factory=dict)

    def fault(self, names: CityNames) -> Fault:
        """Return the reason as a fault of a request."""
        others = names.of(self.others) if self.others else ""
        detail = OBSTACLES[self.code].format(
            cities=names.of(self.cities),
            others=others,
            shared=f"{others} alone" if others else "none",
            noun=names.noun,
            **{name: _word(name, value) for name, value in self.values.items()},
        )
        return Fault("no-plan", pointer=names.pointer(self.cities[0]), said=detail)


class NoTour(Refusal):
    """Every tour has a forbidden leg, a fleet has no plan, or none was found.

    Args:
        obstacles: The reasons, one or more.
        names: How to name the cities in them.
        code: `no-plan`, or `no-road` where only roads are to blame.
    """

    def __init__(
        self,
        obstacles: Iterable[Obstacle],
        names: CityNames | None = None,
        code: str = "no-plan",
    ) -> None:
        self.obstacles = tuple(obstacles)
        faults = [each.fault(names or CityNames()) for each in self.obstacles]
        super().__init__(code, errors=faults)

    def named(self, names: CityNames) -> "NoTour":
        """Return this refusal with other names of the cities."""
        return NoTour(self.obstacles, names, self.code)


def _word(name: str, value: Any) -> Any:
    """Return a value of an obstacle as its sentence has it."""
    return _listed([_BOUNDS[each] for each in value]) if name == "bounds" else value


def _listed(names: Sequence[str]) -> str:
    """Return names as a sentence lists them, such as a, b and c."""
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last
