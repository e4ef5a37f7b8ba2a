"""Improve plans of an archive by small moves of stops, measured under all objectives exactly.

PyVRP cannot minimise the imbalance of a plan or its load distance. It limits the overtime of each
route and the lateness of each visit, but not their sums. Moves are measured by the lengths by which
plans are compared, so they improve all objectives.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from service.fleet.archive import SolutionArchive
from service.fleet.evaluation import first_broken, joined_lengths, route_lengths, violations
from service.fleet.fleet import Array
from service.fleet.goal import FREE
from service.fleet.plans import Plan, Route
from service.fleet.translation import Translation

_NEAR = 10  # nearest stops of each stop: most moves put a stop beside one of them
_FAR = 0.2  # share of moves that put a stop anywhere
_CHECKED = 20  # moves between two calls of `ended`
Lengths = tuple[float, ...]  # of a plan or a route
Changes = Mapping[int, tuple[int, ...]]  # the new stops of each changed route, by its number


class Moves(NamedTuple):
    """How to improve a random plan of the archive by moves, one after another.

    Attributes:
        weights: The weight of each objective, shape (m,). A move is kept if it makes the weighted
            sum of the lengths smaller.
        attempts: The number of moves to try.
    """

    weights: Array
    attempts: int


class Mover:
    """Moves stops within and between the routes of plans.

    Args:
        translation: The translation of the fleet between plans and solutions of PyVRP.
        archive: The plans found so far. New plans that none of them dominates are offered to it.
        random: Chooses plans and moves.
    """

    def __init__(
        self, translation: Translation, archive: SolutionArchive, random: np.random.Generator
    ) -> None:
        self._translation, self._archive, self._random = translation, archive, random
        self._fleet = translation.fleet
        rules = self._fleet.rules
        clients = np.array(rules.clients)
        costs = self._fleet.costs[0][clients[:, np.newaxis], clients] if len(clients) else None
        self._near: dict[int, list[int]] = {}
        if costs is not None:
            order = np.argsort(np.minimum(costs, costs.T), axis=1, kind="stable")
            self._near = {
                stop: [other for other in clients[row].tolist() if other != stop][:_NEAR]
                for stop, row in zip(clients.tolist(), order, strict=True)
            }
        self._types = range(len(rules.vehicles))
        self._optional = [s for s in rules.clients if rules.visits[s].prize is not None]

    def improve(self, moves: Moves, ended: Callable[[], bool]) -> None:
        """Try moves on a random plan, and offer what they find to the archive.

        Args:
            moves: The weights, and the number of moves.
            ended: Called every few milliseconds; True ends the moves.
        """
        archive = self._archive
        start = archive.solutions[int(self._random.integers(len(archive)))]
        plan = self._translation.plan(start)
        of_routes = [route_lengths(self._fleet, each) for each in plan.routes]
        least = float(moves.weights @ joined_lengths(self._fleet, plan, of_routes))
        for attempt in range(moves.attempts):
            if attempt % _CHECKED == 0 and ended():
                return
            moved = self._moved(plan, of_routes)
            if moved is None:
                continue
            lengths = joined_lengths(self._fleet, *moved)
            if not archive.dominates(lengths):
                archive.offer(self._translation.solution(moved[0]), FREE)
            if (value := float(moves.weights @ lengths)) < least:
                (plan, of_routes), least = moved, value

    def _moved(self, plan: Plan, of_routes: Sequence[Lengths]) -> tuple[Plan, list[Lengths]] | None:
        """Return a plan after a random move; None if it breaks a rule.

        Args:
            plan: The plan before the move.
            of_routes: The lengths of its routes.

        Returns:
            The new plan, and the lengths of its routes.
        """
        vehicles = [route.vehicle for route in plan.routes]
        stops = [route.stops for route in plan.routes]
        vehicles += self._spare(vehicles)
        stops += [()] * (len(vehicles) - len(stops))
        changes = self._changes(vehicles, stops)
        routes, lengths = [], []
        for number, vehicle in enumerate(vehicles):
            route = Route(vehicle, changes.get(number, stops[number]))
            if not route.stops:
                continue
            routes.append(route)
            if number in changes:
                if first_broken(self._fleet, route):
                    return None
                lengths.append(route_lengths(self._fleet, route))
            else:
                lengths.append(of_routes[number])
        moved = Plan(tuple(routes))
        shipments = self._fleet.rules.shipments
        return None if shipments and violations(self._fleet, moved) else (moved, lengths)

    def _spare(self, vehicles: Sequence[int]) -> list[int]:
        """Return a list of one random type that has an unused vehicle, or an empty list.

        Args:
            vehicles: The type of the vehicle of each route.
        """
        used = Counter(vehicles)
        types = self._fleet.rules.vehicles
        spare = [each for each in self._types if used[each] < types[each].count]
        return [spare[self._index(spare)]] if spare else []

    def _changes(self, vehicles: Sequence[int], stops: Sequence[tuple[int, ...]]) -> Changes:
        """Return a random move.

        It visits an optional stop or leaves it out, adds or removes a reload, reverses a part of a
        route, or puts a stop elsewhere.

        Args:
            vehicles: The type of the vehicle of each route.
            stops: The stops of each route.
        """
        visited = [number for number, each in enumerate(stops) if each]
        kind = self._random.random()
        if self._optional and kind < 1 / 4:
            return self._with_or_without(stops)
        if not visited:
            return {}
        number = visited[self._index(visited)]
        reload = self._fleet.rules.vehicles[vehicles[number]].reload
        if reload and kind < 3 / 8:
            return {number: self._inserted(stops[number], reload[self._index(reload)])}
        if kind < 1 / 2:
            return {number: self._reversed(stops[number])}
        place = self._index(stops[number])
        stop, left = stops[number][place], stops[number][:place] + stops[number][place + 1 :]
        if stop in self._fleet.rules.depots:
            return {number: left}
        return self._put(stop, {**dict(enumerate(stops)), number: left}, {number})

    def _inserted(self, stops: tuple[int, ...], stop: int) -> tuple[int, ...]:
        place = int(self._random.integers(len(stops) + 1))
        return (*stops[:place], stop, *stops[place:])

    def _with_or_without(self, stops: Sequence[tuple[int, ...]]) -> Changes:
        """Return a move that leaves out a random optional stop, or visits it if it is left out."""
        stop = self._optional[self._index(self._optional)]
        for number, each in enumerate(stops):
            if stop in each:
                return {number: tuple(other for other in each if other != stop)}
        return self._put(stop, dict(enumerate(stops)), set())

    def _put(self, stop: int, stops: dict[int, tuple[int, ...]], changed: set[int]) -> Changes:
        """Return the move that inserts a stop, most often beside a near one.

        Args:
            stop: The stop.
            stops: The stops of all routes without this stop, by the number of the route.
            changed: The numbers of routes that the move has changed already.
        """
        number, place = self._target(stop, stops)
        stops[number] = (*stops[number][:place], stop, *stops[number][place:])
        return {each: stops[each] for each in changed | {number}}

    def _target(self, stop: int, stops: Mapping[int, tuple[int, ...]]) -> tuple[int, int]:
        """Return where to insert a stop: the number of a route, and a place in it."""
        near = self._near.get(stop, [])
        if near and self._random.random() > _FAR:
            beside = near[self._index(near)]
            for number, each in stops.items():
                if beside in each:
                    return number, each.index(beside) + int(self._random.integers(2))
        number = int(self._random.integers(len(stops)))
        return number, int(self._random.integers(len(stops[number]) + 1))

    def _reversed(self, stops: tuple[int, ...]) -> tuple[int, ...]:
        begin, end = sorted(self._random.integers(len(stops) + 1, size=2).tolist())
        return (*stops[:begin], *stops[begin:end][::-1], *stops[end:])

    def _index(self, choices: Sequence[int]) -> int:
        return int(self._random.integers(len(choices)))
