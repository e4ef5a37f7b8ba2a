"""Show what came, and names of the caller, in a sentence: short, in one line and as JSON."""

from pydantic_core import to_json

_LONGEST_NAME = 100  # characters of a caller's name for a stop, where it is quoted


def shorten(text: str) -> str:
    """Return at most 80 characters of what came, to be shown in a sentence."""
    return text if len(text) <= 80 else f"{text[:79]}…"


def show(value: object) -> str:
    """Return what came as a short text, to be shown in a sentence."""
    match value:
        case list():
            return f"a list of {len(value)}"
        case dict():
            return "an object"
        case int() if abs(value) >= 10**40:
            return "an integer of more than 40 digits"
        case _:
            return shorten(to_json(value, inf_nan_mode="constants").decode())


def quoted(name: str) -> str:
    """Return a caller's name for a stop as it is quoted in a sentence."""
    return repr(name[:_LONGEST_NAME])
