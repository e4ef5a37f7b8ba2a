"""Write paths over a map into files for robots: nav_msgs/Path as JSON, or CSV in metres."""

import json
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from paretour import FrontOfAnyKind
from paretour import Path as MapPath
from paretour.kinds import Kind

from service.cli.errors import UsageError

_WRITERS: Mapping[str, Callable[[MapPath], str]] = {
    ".json": lambda path: json.dumps(path.to_nav_path(), separators=(",", ":")) + "\n",
    ".csv": lambda path: path.to_csv(),
}
_NO_PATH = "a path is written only for a map with an origin, as a map.yaml has it"


def check_path_file(file: Path) -> None:
    """Raise UsageError if no path can be written into this file."""
    if file.suffix not in _WRITERS:
        raise UsageError(f"--path must end in .json or .csv, got {file}")
    if file.exists() and not file.is_file():  # writing into a pipe could wait forever
        raise UsageError(f"--path must be a file, got {file}")
    if not file.parent.is_dir():
        raise UsageError(f"--path must be in a directory that exists, got {file}")


def check_path_folder(folder: Path) -> None:
    """Raise UsageError if no paths can be written into this folder."""
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"--path-folder must be a directory, got {folder}")
    if not folder.parent.is_dir():
        raise UsageError(f"--path-folder must be in a directory that exists, got {folder}")


def write_path(path: MapPath | None, file: Path) -> None:
    """Write the path of a tour into a file, in the format of its name.

    Raises:
        UsageError: The path is missing, or the origin of its map is.
    """
    file.write_text(_WRITERS[file.suffix](_located(path)), newline="", encoding="utf-8")


def write_paths(front: FrontOfAnyKind, kind: Kind, folder: Path) -> None:
    """Write all paths of a front into a folder, each as JSON and as CSV. Make the folder.

    Raises:
        UsageError: The paths are missing, or the origin of their map is.
    """
    folder.mkdir(exist_ok=True)
    for name, path in _named_paths(front, kind):
        located = _located(path)
        for suffix, written in _WRITERS.items():
            (folder / f"{name}{suffix}").write_text(written(located), newline="", encoding="utf-8")


def _named_paths(front: Any, kind: Kind) -> Iterator[tuple[str, MapPath | None]]:
    """Yield each path of a front and the name of its file, without the ending."""
    for number, item in enumerate(front):
        if not kind.mover:
            yield f"tour-{number}", item.path
            continue
        named: Counter[str] = Counter()
        for route, (mover, _) in zip(item.routes, kind.routes(item), strict=True):
            name = _file_name(mover)
            named[name] += 1
            # Other ids may have the same letters; a dot is in no name.
            further = f".{named[name]}" if named[name] > 1 else ""
            yield f"plan-{number}-{name}{further}", route.path


def _file_name(robot: str) -> str:
    """Return the id of a robot with only letters, digits and hyphens: it comes from a request."""
    return re.sub(r"[^0-9A-Za-z-]+", "_", robot)[:80]


def _located(path: MapPath | None) -> MapPath:
    if path is None or path.yaws is None:
        raise UsageError(_NO_PATH)
    return path
