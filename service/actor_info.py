"""The metadata of an actor's ONNX file, for those that need no network.

Apart from the actor: who imports ONNX Runtime has threads, and can no longer be forked.
"""

from dataclasses import dataclass
from typing import Any

from service.instance import Kind


@dataclass(frozen=True, kw_only=True)
class ActorInfo:
    """The metadata of an actor's ONNX file.

    Args:
        name: As requests name it.
        digest: SHA-256 of the file, in hex.
        commit: Of the code that wrote the file.
        inputs: The kind of instance that it reads: `coordinates`, shape (n, 4), each plane moved
            and scaled into the unit square; or `matrices`, shape (2, n, n), in units of the
            scale, with zeros on the diagonal.
        sizes: Least and greatest number of cities that it was trained on.
        angles: Least and greatest angle that it was trained on, in degrees.
        config: Of the training run.
        figures: Hypervolumes measured after training, by number of cities.
        repairs: Whether it can repair the tours that it has built.
    """

    name: str
    digest: str
    commit: str
    inputs: Kind
    sizes: Any
    angles: Any
    config: Any
    figures: Any
    repairs: bool = False

    @property
    def identity(self) -> dict[str, str]:
        """The name and digest, as answers report them."""
        return {"name": self.name, "digest": self.digest}

    def serves(self, kind: Kind) -> bool:
        """Return whether it builds tours for instances of a kind: matrices serve both kinds."""
        return self.inputs in ("matrices", kind)
