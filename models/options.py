"""Configurations on the command line: an option for each setting of a dataclass."""

from argparse import ArgumentParser, Namespace
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
        default = declared.default
        parser.add_argument(option, type=type(default), default=default, help=meaning)


def from_options(kind: type[T], options: Namespace, **others: Any) -> T:
    """Return the configuration that the options describe; fields without option come by name."""
    values = {declared.name: getattr(options, declared.name) for declared in _settings(kind)}
    return kind(**values, **others)


def _settings(kind: type[Any]) -> list[Field[Any]]:
    return [declared for declared in fields(kind) if "meaning" in declared.metadata]
