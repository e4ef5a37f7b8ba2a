"""Actors whose choice takes long or warns, in a process that parses and imports this module."""

import time
import warnings
from dataclasses import dataclass

from service.actor_info import ActorInfo
from service.instance import Kind


@dataclass(frozen=True, kw_only=True)
class BusyActor(ActorInfo):
    """An actor whose choice never ends."""

    def serves(self, kind: Kind, objectives: int = 2) -> bool:  # noqa: ARG002
        while True:
            pass


@dataclass(frozen=True, kw_only=True)
class SleepyActor(ActorInfo):
    """An actor whose choice takes time, and none of a processor."""

    def serves(self, kind: Kind, objectives: int = 2) -> bool:
        time.sleep(1)
        return super().serves(kind, objectives)


@dataclass(frozen=True, kw_only=True)
class WarningActor(ActorInfo):
    """An actor whose choice warns, in the process that chooses it."""

    def serves(self, kind: Kind, objectives: int = 2) -> bool:
        for number in range(50):
            warnings.warn_explicit("over\nflow" * 100, RuntimeWarning, "/a/choice.py", number)
        return super().serves(kind, objectives)
