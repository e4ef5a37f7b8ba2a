"""Configurations of small training runs."""

from models.config import NetworkConfig, TrainingConfig

SMALL_NETWORK = NetworkConfig(width=16, heads=2, layers=1, feedforward=32)


def small_config(**changes: object) -> TrainingConfig:
    """Six steps on instances of 5 to 8 cities, but for the changes."""
    settings: dict[str, object] = {
        "network": SMALL_NETWORK,
        "steps": 6,
        "instances": 4,
        "least_cities": 5,
        "most_cities": 8,
        "preferences": 5,
        "starts": 4,
        "validate_every": 3,
        "warmup": 2,
    }
    return TrainingConfig(**{**settings, **changes})
