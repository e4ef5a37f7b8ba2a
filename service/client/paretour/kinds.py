"""The kinds of fronts, named as by the member `kind` of answers, and the parser of each."""

from collections.abc import Callable, Mapping
from typing import Any

from paretour.expect import members, text, unexpected
from paretour.plans import FleetFront, RobotFront, parse_fleet, parse_robots
from paretour.values import Front, parse_front

FrontOfAnyKind = Front | FleetFront | RobotFront

_PARSERS: Mapping[str, Callable[[Mapping[str, Any]], FrontOfAnyKind]] = {
    "front": parse_front,
    "coverage": parse_front,
    "fleet": parse_fleet,
    "robots": parse_robots,
}


def kind_of(document: Mapping[str, Any]) -> str:
    """Return the kind of the front in a JSON answer; "front" if it names none, as in version 0.1.

    Raises:
        UnexpectedAnswer: The kind is unknown.
    """
    kind = members(document, "answer").maybe("kind", text) or "front"
    if kind not in _PARSERS:
        raise unexpected("answer/kind", f"one of {', '.join(_PARSERS)}", kind)
    return kind


def parse_any(document: Mapping[str, Any]) -> FrontOfAnyKind:
    """Return the front in a JSON answer, of any kind.

    Raises:
        UnexpectedAnswer: Its kind is unknown, or a member is missing or wrong.
    """
    return _PARSERS[kind_of(document)](document)
