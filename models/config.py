"""Configurations of networks and training runs: frozen, checked, stored with the weights."""

from dataclasses import asdict, dataclass, fields
from typing import Any

from models.networks.actor import Architecture
from models.networks.build import ACTORS
from models.networks.pa_one import OneActor
from models.options import setting

NAMES = tuple(ACTORS)
OBJECTIVES = ("lagrangian", "weighted-sum", "imitation", "repairs")


@dataclass(frozen=True, kw_only=True)
class NetworkConfig(Architecture):
    """The name and sizes of an actor."""

    name: str = setting("pa-one", f"one of {', '.join(NAMES)}")

    def __post_init__(self) -> None:
        if self.name not in NAMES:
            raise ValueError(f"name must be one of {', '.join(NAMES)}, got {self.name}")
        if self.width % self.heads:
            raise ValueError(f"width {self.width} must be a multiple of heads {self.heads}")
        least = 1 if self.repairs else 0
        if not least <= self.preference_layers <= 1:
            raise ValueError(
                f"preference_layers of {self.name} must be from {least} to 1, "
                f"got {self.preference_layers}"
            )

    @property
    def repairs(self) -> bool:
        """Whether the actor repairs the tours that it built."""
        return self.name.startswith("pa-one")

    @property
    def label(self) -> str:
        """The name, with the paper's minus sign where an ablation leaves a part out."""
        graphless = self.name == "pa-ad" and self.graph_layers == 0
        return self.name + ("-" if graphless or self.preference_layers == 0 else "")


@dataclass(frozen=True, kw_only=True)
class TrainingConfig:
    """The settings of Algorithm 1 of the paper, and of the other ways to train."""

    network: NetworkConfig = NetworkConfig()
    objective: str = setting(
        "weighted-sum", "lagrangian (the paper's), weighted-sum, imitation or repairs"
    )
    objectives: int = setting(
        2, "objectives of an instance, two to four; more than two of PA-One; of repairs the most"
    )
    baseline: str = setting("shared", "critic (the paper's) or shared: the mean over starts")
    steps: int = setting(10_000, "steps in all, at whose end the learning rate ends")
    instances: int = setting(8, "instances a step")
    least_cities: int = setting(40, "least cities of an instance; all of a step have as many")
    most_cities: int = setting(40, "most cities of an instance")
    preferences: int = setting(20, "preferences an instance")
    starts: int = setting(8, "tours for each instance and preference; 1 with a critic")
    learning_rate: float = setting(5e-4, "of actor and critic, at its highest")
    averaging: float = setting(0.998, "share that the averaged weights keep at each step")
    warmup: int = setting(200, "steps over which the learning rate rises")
    clip_gradient: float = setting(1.0, "bound on the norm of the gradient")
    multiplier: float = setting(0.0, "first Lagrange multiplier of every preference")
    least_multiplier: float = setting(0.0, "lower limit of the multipliers")
    most_multiplier: float = setting(200.0, "upper limit of the multipliers")
    ascent_rate: float = setting(1.0, "rise of a multiplier for a mean violation of one")
    validate_every: int = setting(250, "steps between two validations and checkpoints")
    seed: int = setting(1, "of weights, instances, preferences and sampling")

    def __post_init__(self) -> None:
        self._check_objective()
        if self.baseline not in ("critic", "shared"):
            raise ValueError(f"baseline must be critic or shared, got {self.baseline}")
        if self.baseline == "shared" and self.starts < 2:
            raise ValueError(f"a shared baseline needs at least 2 starts, got {self.starts}")
        if self.baseline == "critic" and self.starts != 1:
            raise ValueError(f"with a critic starts must be 1, got {self.starts}")
        if not 2 <= self.least_cities <= self.most_cities:
            raise ValueError(
                "cities must satisfy 2 <= least <= most, "
                f"got {self.least_cities} and {self.most_cities}"
            )
        for name in ("steps", "instances", "preferences", "validate_every"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} must be at least 1, got {getattr(self, name)}")

    def _check_objective(self) -> None:
        if self.objective not in OBJECTIVES:
            raise ValueError(
                f"objective must be one of {', '.join(OBJECTIVES)}, got {self.objective}"
            )
        if self.objective == "repairs" and not self.network.repairs:
            raise ValueError(f"{self.network.name} makes no repairs to learn from")
        most = OneActor.most_objectives if self.network.name == "pa-one" else 2
        if not 2 <= self.objectives <= most:
            raise ValueError(
                f"objectives of {self.network.name} must be from 2 to {most}, got {self.objectives}"
            )
        if self.objectives > 2 and self.objective == "lagrangian":
            raise ValueError(f"the Lagrangian is of two objectives, got {self.objectives}")


def as_plain(config: TrainingConfig) -> dict[str, Any]:
    """Return the configuration as nested dictionaries of numbers and strings."""
    return asdict(config)


def from_plain(plain: dict[str, Any]) -> TrainingConfig:
    """Return the configuration that `as_plain` wrote; earlier ones were all of two objectives.

    Raises:
        ValueError: a name is unknown or missing.
    """
    plain = {"objectives": 2} | plain
    expected = {f.name for f in fields(TrainingConfig)}
    if set(plain) != expected:
        raise ValueError(f"fields must be {sorted(expected)}, got {sorted(plain)}")
    return TrainingConfig(**{**plain, "network": NetworkConfig(**plain["network"])})
