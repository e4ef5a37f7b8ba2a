"""Configurations on the command line: an option for each setting of a dataclass."""

from argparse import SUPPRESS, ArgumentParser, Namespace
from dataclasses import Field, field, fields
from typing import Any, TypeVar

T = TypeVar("T")


def setting(default: Any, meaning: str) -> Any:
    """Declare a field with its default and the phrase that explains it on the command line."""
    return field(default=default, metadata={"meaning": meaning})


def add_options(parser: ArgumentParser, kind: type[Any]) -> None:
    """Add an option for each setting of a configuration, with its default and meaning."""
    for declared in _settings(kind):
        option = "--" + declared.name.replace("_", "-")
        meaning = f"{declared.metadata['meaning']} (default {declared.default})"
        kind_of_value = type(declared.default)
        parser.add_argument(option, type=kind_of_value, default=SUPPRESS, help=meaning)


def from_options(kind: type[T], options: Namespace, **others: Any) -> T:
    """Return the configuration of the options; fields without an option are given by name."""
    return kind(**_given(kind, options), **others)


def differences(config: Any, options: Namespace) -> list[str]:
    """Return a phrase for each given option that differs from a configuration."""
    return [
        f"--{name.replace('_', '-')} {value}, which has {getattr(config, name)}"
        for name, value in _given(type(config), options).items()
        if value != getattr(config, name)
    ]


def _given(kind: type[Any], options: Namespace) -> dict[str, Any]:
    """Return the settings that were given as options, by name; the others have their defaults."""
    names = [declared.name for declared in _settings(kind)]
    return {name: getattr(options, name) for name in names if name in options}


def _settings(kind: type[Any]) -> list[Field[Any]]:
    return [declared for declared in fields(kind) if "meaning" in declared.metadata]
