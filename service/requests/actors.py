"""The actor of a request: the one that it names, or the default for its kind of instance."""

from collections.abc import Mapping

from service.actor_info import ActorInfo
from service.errors import Refusal
from service.instance import Kind

DEFAULT_ACTORS: Mapping[Kind, str] = {"coordinates": "pa-one", "matrices": "pa-one-matrix"}


def choose_actor(actors: Mapping[str, ActorInfo], kind: Kind, name: str | None) -> str:
    """Return the name of the actor for instances of a kind: the one requested, or the default.

    Where the default is not loaded, the first by name that serves the kind takes its place.

    Raises:
        Refusal: The requested actor is not loaded or does not serve the kind, or none does.
    """
    able = sorted(each for each, info in actors.items() if info.serves(kind))
    if name is not None:
        _check_able(name, kind, able, actors)
        return name
    if not able:
        raise Refusal("no-actor", kind=kind)
    return DEFAULT_ACTORS[kind] if DEFAULT_ACTORS[kind] in able else able[0]


def actor_for_plans(actors: Mapping[str, ActorInfo]) -> str:
    """Return the name of the actor whose tours are cut into first plans; empty without one."""
    able = any(info.serves("matrices") for info in actors.values())
    return choose_actor(actors, "matrices", None) if able else ""


def _check_able(name: str, kind: Kind, able: list[str], actors: Mapping[str, ActorInfo]) -> None:
    if name in able:
        return
    among = f"one of {', '.join(able)}" if able else "one that is loaded, and none is"
    if name not in actors:
        raise Refusal("unknown-actor", among=among, came=repr(name[:80]), pointer="/actor")
    inputs = actors[name].inputs
    raise Refusal("unfit-actor", kind=kind, among=among, name=name, inputs=inputs, pointer="/actor")
