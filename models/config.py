"""What a network and a training run are made of: frozen, checked, stored with the weights."""

from argparse import ArgumentParser, Namespace
from dataclasses import Field, asdict, dataclass, field, fields
from typing import Any, TypeVar

T = TypeVar("T")
NAMES = ("pa-one", "pa-one-matrix", "pa-at", "pa-ean", "pa-ad")


def setting(default: Any, meaning: str) -> Any:
    """A field with its default and the sentence that explains it on the command line."""
    return field(default=default, metadata={"meaning": meaning})


@dataclass(frozen=True, kw_only=True)
class NetworkConfig:
    """Which actor, and how large."""

    name: str = setting("pa-one", f"one of {', '.join(NAMES)}")
    width: int = setting(128, "features of a city")
    heads: int = setting(8, "attention heads")
    layers: int = setting(5, "encoder layers")
    feedforward: int = setting(512, "hidden features of an encoder layer")
    clip: float = setting(10.0, "bound on the pointer's logits before distances are taken off")
    graph_layers: int = setting(3, "of PA-AD's graph encoder; 0 leaves out all but its features")
    preference_layers: int = setting(1, "0 leaves the preference out, as in the paper's ablation")

    def __post_init__(self) -> None:
        if self.name not in NAMES:
            raise ValueError(f"name must be one of {', '.join(NAMES)}, got {self.name}")
        if self.width % self.heads:
            raise ValueError(f"width {self.width} must be a multiple of heads {self.heads}")
        least = 1 if self.name.startswith("pa-one") else 0
        if not least <= self.preference_layers <= 1:
            raise ValueError(
                f"preference_layers of {self.name} must be from {least} to 1, "
                f"got {self.preference_layers}"
            )

    @property
    def label(self) -> str:
        """The name, with the paper's minus where a part is left out as in its ablations."""
        graphless = self.name == "pa-ad" and self.graph_layers == 0
        return self.name + ("-" if graphless or self.preference_layers == 0 else "")


@dataclass(frozen=True, kw_only=True)
class TrainingConfig:
    """Algorithm 1 of the paper, and what it leaves open. Angles of preferences: (0, 90) degrees."""

    network: NetworkConfig = NetworkConfig()
    objective: str = setting("weighted-sum", "lagrangian (the paper's), weighted-sum or imitation")
    baseline: str = setting("shared", "critic (the paper's) or shared: the mean over starts")
    steps: int = setting(10_000, "gradient steps in all; the learning rate ends at their end")
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
        if self.objective not in ("lagrangian", "weighted-sum", "imitation"):
            raise ValueError(
                f"objective must be lagrangian, weighted-sum or imitation, got {self.objective}"
            )
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


def add_options(parser: ArgumentParser, kind: type[Any]) -> None:
    """An option for each setting of a configuration, with its default and its sentence."""
    for each in _settings(kind):
        option = "--" + each.name.replace("_", "-")
        meaning = f"{each.metadata['meaning']} (default {each.default})"
        parser.add_argument(option, type=type(each.default), default=each.default, help=meaning)


def from_options(kind: type[T], given: Namespace, **others: Any) -> T:
    """The configuration that the options describe; what is no setting comes by name."""
    return kind(**{each.name: getattr(given, each.name) for each in _settings(kind)}, **others)


def _settings(kind: type[Any]) -> list[Field[Any]]:
    return [each for each in fields(kind) if "meaning" in each.metadata]


def as_plain(config: TrainingConfig) -> dict[str, Any]:
    """The configuration as nested dictionaries of numbers and strings."""
    return asdict(config)


def from_plain(plain: dict[str, Any]) -> TrainingConfig:
    """The inverse of `as_plain`; unknown or missing names are errors."""
    expected = {f.name for f in fields(TrainingConfig)}
    if set(plain) != expected:
        raise ValueError(f"fields must be {sorted(expected)}, got {sorted(plain)}")
    return TrainingConfig(**{**plain, "network": NetworkConfig(**plain["network"])})
