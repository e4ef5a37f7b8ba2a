"""Read the maps of ROS, a map.yaml and the picture that it names, as a request for coverage."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

from paretour.members import CoverageRequest

_MOST_BYTES = 2**16  # of a map.yaml, which has some hundred
_REQUIRED = ("image", "resolution", "origin", "occupied_thresh", "free_thresh", "negate")


def read_ros_map(path: str | Path) -> tuple[CoverageRequest, bytes]:
    """Return what a map.yaml says of its map, as members of a request, and the picture it names.

    The path of the picture counts from the folder of the map.yaml, as in map_server. It is not
    decoded here. Needs PyYAML: `pip install 'paretour-client[ros]'`.

    Args:
        path: Of the map.yaml.

    Raises:
        ValueError: The file is not a map.yaml; the message says what is wrong.
        OSError: It, or its picture, cannot be read.
        ModuleNotFoundError: PyYAML is not installed.
    """
    yaml_path = Path(path).expanduser()
    keys = _parse(yaml_path)
    if missing := [name for name in _REQUIRED if name not in keys]:
        raise ValueError(f"a map.yaml must have {', '.join(missing)}")
    request = {
        "cell_size": _number(keys, "resolution"),
        "origin": _origin(keys),
        "mode": str(keys.get("mode", "trinary")).lower(),
        "negate": _flag(keys),
        "occupied_thresh": _number(keys, "occupied_thresh"),
        "free_thresh": _number(keys, "free_thresh"),
    }
    picture = yaml_path.parent / Path(str(keys["image"])).expanduser()
    return cast(CoverageRequest, request), picture.read_bytes()


def _parse(path: Path) -> Mapping[str, Any]:
    import yaml

    with path.open("rb") as file:
        content = file.read(_MOST_BYTES + 1)
    if len(content) > _MOST_BYTES:
        raise ValueError(f"a map.yaml must have at most {_MOST_BYTES} bytes, got more")
    try:
        # An alias may stand for what fills the memory, and a map.yaml needs none.
        if any(isinstance(token, yaml.AliasToken) for token in yaml.scan(content, yaml.SafeLoader)):
            raise ValueError("a map.yaml must have no aliases")
        keys = yaml.safe_load(content)
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(f"a map.yaml must be YAML: {' '.join(str(error).split())}") from None
    if not isinstance(keys, dict):
        raise ValueError("a map.yaml must be keys with values")
    return keys


def _origin(keys: Mapping[str, Any]) -> list[float]:
    values = keys["origin"]
    if not isinstance(values, list) or len(values) != 3:
        raise ValueError(f"origin must be x, y and yaw, got {str(values)[:80]}")
    return [_as_number(value, "origin") for value in values]


def _flag(keys: Mapping[str, Any]) -> bool:
    """Return negate, which is 0 or 1, or a truth value."""
    if keys["negate"] not in (0, 1):
        raise ValueError(f"negate must be 0 or 1, got {str(keys['negate'])[:80]}")
    return bool(keys["negate"])


def _number(keys: Mapping[str, Any], name: str) -> float:
    return _as_number(keys[name], name)


def _as_number(value: Any, name: str) -> float:
    """Return a number; PyYAML takes 5e-2, which is one in YAML 1.2, for a string."""
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} must be a number, got {str(value)[:80]}") from None
