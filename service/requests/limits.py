"""The limits of a service on the contents of requests, and the checks of them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from service.day.breakpoints import Breakpoints
from service.errors import Fault, Refusal, invalid
from service.front import PlanOptions
from service.instance import Array, Kind
from service.requests.fields import PlanFields, PlanRequest, SearchFields
from service.requests.stops import ROAD_MEASURES, Measured, Source, Stops, Traffic, base_of
from service.requests.straight_sources import are_straight
from service.requests.validation import too_many_cities

_TOURS_BY_ID = 100  # initial tours that may name every stop by its id
_ID_BYTES = 40  # of ids that count as one cell of an answer: a UUID in quotation marks
AnyRequest = TypeVar("AnyRequest", bound=SearchFields)
AnyPlanRequest = TypeVar("AnyPlanRequest", bound=PlanRequest)


@dataclass(frozen=True, kw_only=True)
class Limits:
    """The largest amounts that a request may contain or ask for.

    Args:
        cities: Stops in two planes.
        matrix_cities: Stops whose costs are matrices: as they come, as they are measured, or over
            a map.
        network_cities: Stops for which a network builds tours.
        survey_seconds: Processor seconds to find the paths between the places of a map.
        fleet_stops: Stops of a fleet, all of whose costs are straight lines, and places that
            several robots share.
        path_cells: Cells of all paths of an answer, and stops of all its tours; long ids of stops
            count for more.
        size: Tours to return, or initial tours in a request.
        breakpoints: Breakpoints of all pairs of stops, in all objectives.
        seconds: The time limit of planning.
        roads: Whether a routing engine is configured, so that costs may be by road.
        traffic: Whether it has historical traffic.
        profiles: The profiles of vehicles that it knows.
    """

    body_bytes: int
    cities: int
    cells: int
    preferences: int
    size: int
    seconds: float
    matrix_cities: int = 1000
    network_cities: int = 5000
    path_cells: int = 2**21
    survey_seconds: float = 10.0
    fleet_stops: int = 5000
    repairs: int = 200
    breakpoints: int = 2**20
    roads: bool = False
    traffic: bool = False
    profiles: tuple[str, ...] = ()

    @property
    def of_options(self) -> Mapping[str, float]:
        """The largest value of each option that has a limit."""
        return {
            "preferences": self.preferences,
            "size": self.size,
            "repairs": self.repairs,
            "time_limit": self.seconds,
        }

    def most_cities(self, kind: Kind) -> int:
        """Return the most cities of an instance of a kind."""
        return self.cities if kind == "coordinates" else min(self.cities, self.matrix_cities)

    def most_places(self, *, shared: bool) -> int:
        """Return the most places on a map, which several robots share or one visits."""
        places = self.most_cities("matrices")
        return min(places, self.fleet_stops) if shared else places

    def most_tours(self, n: int, id_bytes: int = 0) -> int:
        """Return the most tours of n cities, each with its return, that an answer may have.

        Args:
            id_bytes: Bytes of the ids in one tour.
        """
        return max(1, min(self.size, self.path_cells // max(n + 1, id_bytes // _ID_BYTES)))


def check_structure(body: bytes, limits: Limits) -> None:
    """Raise a refusal where a body has more of anything than any request under the limits.

    A parser spends a hundred bytes or more on each string, array and object, and most on members
    that no request has. They are counted by their characters, before parsing.

    Raises:
        Refusal: There are more.
    """
    strings = (body.count(b'"') + 1) // 2
    arrays, objects, members = body.count(b"["), body.count(b"{"), body.count(b":")
    most_strings = 1000 + (8 + _TOURS_BY_ID) * limits.cities
    # A breakpoint is an array, and so is the list of those of a pair.
    most_rows = max(limits.cells // 8, 2 * limits.breakpoints)
    most_arrays = 1000 + 8 * limits.cities + 2 * limits.size + most_rows
    most_objects = 1000 + 8 * limits.cities + 2 * limits.size
    most_members = 1000 + 32 * limits.cities
    if members > most_members:  # or texts have colons, as times and ids do
        members = body.translate(None, b" \t\r\n").count(b'":')
    for name, limit, actual in (
        ("members", most_members, members),
        ("objects", most_objects, objects),
        ("strings", most_strings, strings),
        ("arrays", most_arrays, arrays),
    ):
        if actual > limit:
            demand = f"have at most {limit} {name}, got {actual}"
            raise Refusal("body-too-complex", demand=demand, limit=limit, actual=actual)


def within_limits(request: AnyRequest, n: int, limits: Limits, id_bytes: int = 0) -> AnyRequest:
    """Return a request about n cities, with each default above its limit lowered to it.

    Args:
        id_bytes: Bytes of the ids in one tour, or one plan, of the answer.

    Raises:
        Refusal: It asks for more than the limits allow.
    """
    for name, limit in limits.of_options.items():
        if name in request.model_fields_set:
            amount = getattr(request, name)
            check_limit(name, limit, len(amount) if isinstance(amount, list) else amount)
    most = limits.most_tours(n, id_bytes)
    if "size" in request.model_fields_set and request.size > most:
        by_ids = most < limits.most_tours(n)
        code = "size-too-large-for-ids" if by_ids else "size-too-large"
        raise invalid("size", code, limit=most, cities=n, came=request.size)
    return _lowered(request, defaults(limits, n, id_bytes))


def _lowered(request: AnyRequest, values: Mapping[str, float]) -> AnyRequest:
    """Return a request in which no default is above these."""
    given = request.model_fields_set
    lowered = {k: v for k, v in values.items() if k not in given and v < getattr(request, k, v)}
    if not lowered:
        return request
    copied = request.model_copy(update=lowered)
    # A field with a lower default still counts as not given.
    copied.model_fields_set.difference_update(lowered)
    return copied


def tours_within_limits(
    request: AnyPlanRequest, n: int, limits: Limits, id_bytes: int = 0
) -> AnyPlanRequest:
    """Return a request for tours of n cities as `within_limits` does, with its tours checked.

    Raises:
        Refusal: Over a limit, or a start or an initial tour that does not fit n cities.
    """
    _check_ends(request, n)
    found = within_limits(request, n, limits, id_bytes)
    check_limit("initial_tours", limits.size, len(request.initial_tours))
    ends = request.ends
    for index, tour in enumerate(request.initial_tours):
        if len(tour) != n or sorted(tour) != list(range(n)):
            raise invalid(f"initial_tours/{index}", "not-all-cities", last=n - 1)
        for name, place, city in (("start", 0, ends.start), ("end", -1, ends.end)):
            if city is not None and tour[place] != city:
                values = {"end": name, "city": city, "came": tour[place]}
                raise invalid(f"initial_tours/{index}", "not-at-the-end", **values)
    return found


def _check_ends(request: PlanRequest, n: int) -> None:
    """Raise a refusal where the ends of open routes do not fit n cities, or tours are closed."""
    for name, city in (("start", request.start), ("end", request.end)):
        if city is not None and city >= n:
            raise invalid(name, "not-an-index", noun="a city", last=n - 1, came=city)
    if request.closed and request.end is not None:
        raise invalid("end", "end-of-closed", came=request.end)
    if not request.closed and n > 1 and request.ends.start == request.end is not None:
        raise invalid("end", "end-is-start", came=request.end)


def check_reference_point(
    options: PlanOptions, least: Callable[[], Array], noun: str = "tour"
) -> None:
    """Raise a refusal if it is clear that no tour or plan lies below the reference point.

    Every hypervolume would be 0.

    Args:
        options: The options, with the reference point if one was given.
        least: Returns lower bounds of all lengths, shape (m,).
        noun: What the front consists of, for the sentence.

    Raises:
        Refusal: In one objective, no tour or plan can be shorter.
    """
    if options.reference_point is None:
        return
    lengths = zip(options.reference_point, least(), strict=True)
    for m, (length, shortest) in enumerate(lengths):
        if length <= shortest:
            values = {"least": float(shortest), "noun": noun, "came": float(length)}
            raise invalid(f"reference_point/{m}", "not-below", **values)


def within_network(options: PlanOptions, n: int, limits: Limits) -> PlanOptions:
    """Return the options for n cities, without tours of a network if n is too many for it.

    Raises:
        Refusal: They are too many, and the request needs tours of a network: it has preferences, or
            no time for a search.
    """
    if n <= limits.network_cities:
        return options
    for part, asked in (
        ("time_limit", options.time_limit == 0),
        ("preferences", not options.fewer),
    ):
        if asked:
            most = limits.network_cities
            raise Refusal(
                "too-many-for-network", name=part, pointer=f"/{part}", limit=most, actual=n
            )
    return replace(options, directions=options.directions[:0])


def objective_at(number: int) -> str:
    """Return the part of a request that is an objective."""
    return f"objectives/{number}"


def check_breakpoints(
    sources: Sequence[Source], limits: Limits, part_of: Callable[[int], str] = objective_at
) -> None:
    """Raise a refusal where costs have too many breakpoints; the same costs count once.

    The refusal names the part with the most; for `part_of` see `check_router`.
    """
    by_pair = {id(x): (x.count, m) for m, x in enumerate(sources) if isinstance(x, Breakpoints)}
    count, most = sum(each for each, _ in by_pair.values()), limits.breakpoints
    if count > most:
        part = f"{part_of(max(by_pair.values())[1])}/breakpoints"
        fault = Fault.of(part, "too-many-breakpoints", limit=most, came=count)
        raise Refusal("invalid-request", errors=[fault], limit=most, actual=count)


def check_router(
    sources: Sequence[Source], limits: Limits, part_of: Callable[[int], str] = objective_at
) -> None:
    """Raise a refusal where costs by road or traffic are asked for, and no engine has them.

    Args:
        part_of: Returns the part of the request that has a source, by the number of the source.
    """
    for m, source in enumerate(map(base_of, sources)):
        if isinstance(source, Traffic) and not limits.traffic:
            part = f"{part_of(m)}/traffic"
            raise Refusal("no-traffic", name=part, pointer=f"/{part}")
        if limits.roads:
            continue
        if isinstance(source, Measured) and source.measure in ROAD_MEASURES:
            part = f"{part_of(m)}/from"
            raise Refusal("no-router", name=part, measure=source.measure, pointer=f"/{part}")


def check_fleet(
    part: str,
    stops: Stops,
    limits: Limits,
    time_limit: float,
    code: str = "too-many-unless-straight",
) -> None:
    """Raise a refusal where a fleet has too many stops for its costs, or for the network.

    Args:
        part: The part of the request that is refused.
        time_limit: The seconds of planning; with none, the network reads matrices.
        code: The code of what is wrong with the part.
    """
    most = min(limits.fleet_stops, limits.matrix_cities)
    if stops.n <= most:
        return
    if not are_straight(stops.sources):
        raise too_many_cities(part, most, stops.n, code)
    if time_limit == 0:
        part = "time_limit"
        raise Refusal(
            "too-many-for-network", name=part, pointer=f"/{part}", limit=most, actual=stops.n
        )


def defaults(limits: Limits, n: int = 1, id_bytes: int = 0) -> dict[str, float]:
    """Return the defaults for n cities, lowered so that none is over a limit.

    Args:
        id_bytes: Bytes of the ids in one tour.
    """
    largest = {**limits.of_options, "size": limits.most_tours(n, id_bytes)}
    fields = PlanFields.model_fields
    return {name: min(fields[name].default, most) for name, most in largest.items()}


def check_limit(name: str, limit: float, actual: float) -> None:
    """Raise a refusal where a field is over its limit."""
    if actual > limit:
        raise Refusal("over-limit", name=name, pointer=f"/{name}", limit=limit, actual=actual)
