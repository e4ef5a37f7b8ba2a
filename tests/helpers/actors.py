"""Stand-ins for released actors, to put behind a server."""

import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from service.actor_info import ActorInfo
from service.construction.call_estimate import CallEstimate
from service.instance import Instance, Kind
from service.objectives import MOST_OBJECTIVES


def info_of(name: str, inputs: Kind, repairs: bool = False) -> ActorInfo:
    """Return the information of an actor with this name that reads coordinates or matrices."""
    return ActorInfo(
        name=name,
        digest="0" * 64,
        commit="0000000",
        inputs=inputs,
        sizes=[20, 60],
        angles=[0, 90],
        config={},
        figures={},
        repairs=repairs,
        most_objectives=MOST_OBJECTIVES,
    )


@dataclass(frozen=True)
class Shuffler:
    """An actor that shuffles the cities, each time the same way.

    With a gate, which is the path of a file, it touches `<gate>.started` at each call and waits
    until the gate exists. So a test in another process sees that it began, and lets it go on.
    """

    gate: Path | None = None
    info: ActorInfo = field(default_factory=lambda: info_of("pa-one", "coordinates"))

    @property
    def estimate(self) -> CallEstimate:
        """An estimate that learns nothing: a call that waited at the gate makes no other late."""
        return CallEstimate("coordinates")

    @property
    def started(self) -> bool:
        """Whether a call has reached the gate since it was closed."""
        assert self.gate is not None
        return self.gate.with_suffix(".started").exists()

    def open(self) -> None:
        """Let all calls pass."""
        assert self.gate is not None
        self.gate.touch()

    def close(self) -> None:
        """Make the next call wait."""
        assert self.gate is not None
        for mark in (self.gate, self.gate.with_suffix(".started")):
            mark.unlink(missing_ok=True)

    def load(self) -> None:
        """Do nothing: there is no network."""

    def tours(self, instance: Instance, preferences: np.ndarray, _repairs: int = 0) -> np.ndarray:
        """Return one random tour for each preference, once the gate is open."""
        if self.gate is not None:
            self.gate.with_suffix(".started").touch()
            while not self.gate.exists():
                time.sleep(0.005)
        rng = np.random.default_rng(0)
        return np.array([rng.permutation(instance.n) for _ in preferences])

    def terminate(self) -> None:
        """Do nothing: a call ends when the gate opens."""


class Broken(Shuffler):
    """An actor that raises RuntimeError at every call."""

    def tours(self, instance: Instance, preferences: np.ndarray, _repairs: int = 0) -> np.ndarray:
        """Raise RuntimeError."""
        raise RuntimeError(f"no tour of {instance.n} cities for {len(preferences)} preferences")
