"""The refusals about roads: stops that no road leads to, and a routing engine that fails."""

from collections.abc import Sequence

from service.errors.exceptions import MOST_FAULTS, Fault, Refusal, summarize

_LONGEST_NAME = 100  # characters of a caller's name for a stop, where it is quoted


class OffRoad(Refusal):
    """Stops, given by index and id, lie too many metres from every road."""

    def __init__(self, stops: Sequence[tuple[int, str]], snap: float) -> None:
        faults = [
            Fault(
                f"stop {_quoted(name)} must lie within {snap:g} m of a road, and does not",
                f"/stops/{index}/location",
            )
            for index, name in stops
        ]
        super().__init__("off-road", errors=faults[:MOST_FAULTS], detail=summarize(faults))


class NoRoad(Refusal):
    """There is no way by road between some stops.

    Each missing way is given as the index of the stop to look at, and the ids of both its ends.
    """

    def __init__(self, ways: Sequence[tuple[int, str, str]]) -> None:
        faults = [
            Fault(
                f"there must be a way by road from stop {_quoted(origin)} to stop"
                f" {_quoted(destination)}, and the routing engine knows none",
                f"/stops/{index}",
            )
            for index, origin, destination in ways
        ]
        super().__init__("no-road", errors=faults[:MOST_FAULTS], detail=summarize(faults))


class RouterUnavailable(Refusal):
    """The routing engine does not answer, or answers that it is busy."""

    def __init__(self) -> None:
        super().__init__("router-unavailable")


class RouterUnusable(Refusal):
    """The routing engine's answer is not as documented; the reason quotes none of its text."""

    def __init__(self, reason: str) -> None:
        super().__init__("router-unusable", reason=reason)


class RouterTooSlow(Refusal):
    """The routing engine took longer than its time limit."""

    def __init__(self, seconds: float) -> None:
        super().__init__("router-too-slow", limit=seconds)


class StreetsTooLong(Refusal):
    """Lines along streets have more legs or positions than one answer may have."""

    def __init__(self, parts: str, limit: int, actual: int | None = None) -> None:
        super().__init__("streets-too-long", parts=parts, limit=limit, actual=actual)


def _quoted(name: str) -> str:
    return repr(name[:_LONGEST_NAME])
