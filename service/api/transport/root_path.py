"""The path under which a proxy shows the service. Settings and requests name one."""

import re

# Segments without escapes, and not .. or empty: //other.example would be another server.
_ROOT_PATH = re.compile(r"(/[A-Za-z0-9_~-][A-Za-z0-9._~-]*)*")
_MOST_LETTERS = 200


def is_root_path(path: str) -> bool:
    """Return whether a text is such a path, or empty, for the service itself."""
    return len(path) <= _MOST_LETTERS and _ROOT_PATH.fullmatch(path) is not None
