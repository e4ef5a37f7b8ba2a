"""The sources of costs between the stops of the rest of a fleet's day."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from service.errors import invalid
from service.fleet.fleet import LAYERS
from service.fleet.rules import Rules
from service.objectives import Objective
from service.reliability.spread import Spread
from service.requests.replan.costs import AllStops, between, changed_sources, extended_sources
from service.requests.replan.fields import CostEntry
from service.requests.stops import Matrix, Source, base_of
from service.requests.task import UnmeasuredFleet


def sources_of_rest(
    fleet: UnmeasuredFleet,
    objectives: Sequence[Objective],
    entries: Sequence[CostEntry],
    stops: AllStops,
    chosen: NDArray[np.int64],
) -> list[Source]:
    """Return the sources of both costs between some of the stops, by each profile of vehicles.

    Args:
        fleet: The fleet that is driven.
        entries: Costs that have changed, for all profiles.
        chosen: The stops of the rest.

    Raises:
        Refusal: Costs of a new stop are missing, or changed costs are of no objective or stop.
    """
    names, sources = _names_of_costs(fleet.rules, objectives), fleet.stops.sources
    pairs = [sources[at : at + LAYERS] for at in range(0, len(sources), LAYERS)]
    _check_profiles(pairs, names, stops)
    found: list[Source] = []
    for pair in pairs:
        # A fleet with one source has the same costs twice.
        extended = extended_sources(pair[: len(names)], names, stops)
        changed, _ = changed_sources(extended, names, entries, stops)
        placed = [between(source, chosen) for source in changed]
        found += [*placed, placed[0]][:LAYERS]
    return found


def spreads_of_rest(
    fleet: UnmeasuredFleet, sources: Sequence[Source], chosen: NDArray[np.int64]
) -> tuple[Spread, ...]:
    """Return the times of several days between some of the stops, if the fleet has them.

    Times of new stops, and those that have changed, are the same on all days.

    Args:
        fleet: The fleet that is driven.
        sources: The sources of both costs of the rest.
        chosen: Its stops, among all.
    """
    known = [each.days for each in fleet.stops.spreads if each is not None]
    if not known or known[0] is None:
        return ()
    clock = fleet.rules.clock or 0
    before, now = fleet.stops.sources[clock], sources[clock]
    assert isinstance(before, Matrix)
    assert isinstance(now, Matrix)
    days = np.repeat(now.costs[np.newaxis], len(known[0]), axis=0)
    places = np.flatnonzero(chosen < len(before.costs))
    rows, old = places[:, np.newaxis], chosen[places]
    same = now.costs[rows, places] == before.costs[old[:, np.newaxis], old]
    days[:, rows, places] = np.where(
        same, known[0][:, old[:, np.newaxis], old], days[:, rows, places]
    )
    return (Spread(days=days),)


def _names_of_costs(rules: Rules, objectives: Sequence[Objective]) -> list[str]:
    """Return the name of the objective that each costs are of; of own times, the second's."""
    names: dict[int, str] = {}
    for objective, over, layer in zip(objectives, rules.over, rules.layers, strict=True):
        if over in ("sum", "max"):
            names.setdefault(layer, objective.name)
    if rules.clock is not None:
        names.setdefault(rules.clock, objectives[rules.clock].name)
    return [names[layer] for layer in sorted(names)]


def _check_profiles(
    pairs: Sequence[Sequence[Source]], names: Sequence[str], stops: AllStops
) -> None:
    """Raise a refusal of a new stop where each profile of vehicles has its own matrix.

    Args:
        pairs: The sources of both costs, by each profile.
        names: The name of the objective that each costs are of.
    """
    if not stops.new:
        return
    for name, *sources in zip(names, *pairs, strict=False):
        matrices = [base for each in sources if isinstance(base := base_of(each), Matrix)]
        if not all(np.array_equal(each.costs, matrices[0].costs) for each in matrices):
            raise invalid(next(iter(stops.new)), "profiles-need-matrices", objective=name)
