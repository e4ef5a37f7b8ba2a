"""Which of the loaded actors serves a request."""

from collections.abc import Mapping

from service.actor import ActorFacts
from service.errors import Fault, Refusal
from service.instance import Kind

DEFAULT_ACTORS: Mapping[Kind, str] = {"coordinates": "pa-one", "matrices": "pa-one-matrix"}


def choose_actor(loaded: Mapping[str, ActorFacts], kind: Kind, name: str | None) -> str:
    """The name of the actor asked for; without one, of the default for instances of this kind.

    Where the default is not loaded, the first by name that serves the kind takes its place.

    Raises:
        Refusal: it is not loaded, or no actor that serves the kind is.
    """
    able = sorted(each for each, facts in loaded.items() if facts.serves(kind))
    if name is not None:
        _check_able(name, kind, able, loaded)
        return name
    if not able:
        sentence = f"{kind} need an actor that reads them, and none is loaded"
        raise Refusal(422, "no-actor", sentence)
    return DEFAULT_ACTORS[kind] if DEFAULT_ACTORS[kind] in able else able[0]


def _check_able(name: str, kind: Kind, able: list[str], loaded: Mapping[str, ActorFacts]) -> None:
    if name in able:
        return
    among = f"one of {', '.join(able)}" if able else "one that is loaded, and there is none"
    if name in loaded:
        reads = loaded[name].inputs
        sentence = f"actor must read {kind}, as {among}; {name} reads {reads} alone"
        code = "unfit-actor"
    else:
        sentence = f"actor must be {among}, got {name[:80]!r}"
        code = "unknown-actor"
    raise Refusal(422, code, sentence, errors=[Fault(pointer="/actor", detail=sentence)])
