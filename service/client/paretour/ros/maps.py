"""Read maps of ROS (a map.yaml and the picture that it names) as requests for coverage."""

import math
import os
import stat
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

from paretour.members import CoverageRequest

_MOST_BYTES = 2**16  # in a map.yaml, which usually has about a hundred
_MOST_PICTURE = 2**30  # bytes; the service allows far fewer
_MOST_BRACKETS = 100  # in a map.yaml, which usually has two
_SHOWN = 80  # characters of a wrong value in a sentence
_REQUIRED = ("image", "resolution", "origin", "occupied_thresh", "free_thresh", "negate")


def read_ros_map(path: str | Path) -> tuple[CoverageRequest, bytes]:
    """Return the members of a request that a map.yaml defines, and the content of its picture.

    The path of the picture is relative to the folder of the map.yaml, as in map_server. The picture
    is not decoded. Needs PyYAML: `pip install 'paretour-client[ros]'`.

    Args:
        path: The path of the map.yaml.

    Raises:
        ValueError: The file is not a map.yaml; the message says what is wrong.
        OSError: It, or its picture, cannot be read.
        ModuleNotFoundError: PyYAML is not installed.
    """
    yaml_path = Path(path)
    request, image = parse_ros_map(read_bounded(yaml_path, _MOST_BYTES))
    return request, read_bounded(yaml_path.parent / image, _MOST_PICTURE)


def parse_ros_map(content: bytes) -> tuple[CoverageRequest, str]:
    """Return the members of a request that a map.yaml defines, and the path of its picture.

    Raises:
        ValueError: The bytes are not a map.yaml; the message says what is wrong.
        ModuleNotFoundError: PyYAML is not installed.
    """
    if len(content) > _MOST_BYTES:
        raise ValueError(f"a map.yaml must have at most {_MOST_BYTES} bytes, got more")
    keys = _parse(content)
    if missing := [name for name in _REQUIRED if name not in keys]:
        raise ValueError(f"a map.yaml must have {', '.join(missing)}")
    request = {
        "cell_size": _number(keys, "resolution"),
        "origin": _origin(keys),
        "mode": _text(keys, "mode", "trinary").lower(),
        "negate": _flag(keys),
        "occupied_thresh": _number(keys, "occupied_thresh"),
        "free_thresh": _number(keys, "free_thresh"),
    }
    return cast(CoverageRequest, request), _text(keys, "image")


def read_bounded(path: Path, most: int) -> bytes:
    """Return the bytes of a regular file; never wait for another kind of file, such as a pipe.

    Raises:
        ValueError: It is not a regular file, has more bytes, or has an impossible name.
        OSError: It cannot be read.
    """
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
    with os.fdopen(descriptor, "rb") as file:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise ValueError(f"{str(path)[:_SHOWN]!r} must be a regular file")
        content = file.read(most + 1)
    if len(content) > most:
        raise ValueError(f"{str(path)[:_SHOWN]!r} must have at most {most} bytes, got more")
    return content


def _parse(content: bytes) -> Mapping[str, Any]:
    """Return the values of a map.yaml, each as a text or a list of texts."""
    import yaml

    # A parser of YAML goes down a level for each bracket, and PyYAML takes quadratic time for that.
    if content.count(b"[") + content.count(b"{") > _MOST_BRACKETS:
        raise ValueError(f"a map.yaml must have at most {_MOST_BRACKETS} brackets, got more")
    try:
        root = yaml.compose(content, yaml.SafeLoader)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise ValueError(f"a map.yaml must be YAML: {' '.join(str(error).split())}") from None
    if not isinstance(root, yaml.MappingNode):
        raise ValueError("a map.yaml must be keys with values")
    # A key that is a list may repeat other lists: writing it out might never end.
    return {
        key.value: _value(value) for key, value in root.value if isinstance(key, yaml.ScalarNode)
    }


def _value(node: Any) -> str | list[str] | None:
    """Return the value of a node of YAML as text; numbers are read from it later."""
    if isinstance(node.value, str):
        return node.value
    if all(isinstance(each.value, str) for each in node.value if hasattr(each, "value")):
        return [getattr(each, "value", "") for each in node.value]
    return None


def _text(keys: Mapping[str, Any], name: str, default: str = "") -> str:
    text = keys.get(name, default)
    if not isinstance(text, str) or not text or "\0" in text:
        raise ValueError(f"{name} must be a text, got {_shown(text)}")
    return text


def _shown(value: object) -> str:
    return repr(value)[:_SHOWN]


def _origin(keys: Mapping[str, Any]) -> list[float]:
    values = keys["origin"]
    if not isinstance(values, list) or len(values) != 3:
        raise ValueError(f"origin must be x, y and yaw, got {_shown(values)}")
    return [_as_number(value, "origin") for value in values]


def _flag(keys: Mapping[str, Any]) -> bool:
    """Return negate, which is 0 or 1, or a boolean of YAML."""
    flags = {"0": False, "false": False, "no": False, "1": True, "true": True, "yes": True}
    value = keys["negate"]
    if not isinstance(value, str) or value.lower() not in flags:
        raise ValueError(f"negate must be 0 or 1, got {_shown(value)}")
    return flags[value.lower()]


def _number(keys: Mapping[str, Any], name: str) -> float:
    return _as_number(keys[name], name)


def _as_number(value: Any, name: str) -> float:
    """Return a finite number, in the form of YAML 1.2, in which 5e-2 is a number."""
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} must be a number, got {_shown(value)}") from None
    if not math.isfinite(number):
        raise ValueError(f"{name} must be a finite number, got {_shown(value)}")
    return number
